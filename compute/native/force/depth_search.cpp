#include "compute/native/force/depth_search.h"

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <cstdlib>
#include <cstring>
#include <limits>
#include <optional>

#include "compute/native/frame_helper.h"
#include "compute/native/processor.h"
#include "compute/scene/exact.h"
#include "model/bytes_of.h"
#include "shaders/shared/frame_field.h"

namespace palpate {
namespace {

constexpr std::size_t kEight = TriangleTree::kEight;
constexpr std::int64_t kRounding =
    16;  // steps by which a distance may be off, and more (EXACTNESS section 4)

std::int64_t product(const Int3& a, const Int3& b) {
  return std::int64_t{a.x} * b.x + std::int64_t{a.y} * b.y + std::int64_t{a.z} * b.z;
}

/// floor(√v), 0 ≤ v < 2^62: a double's root is off by less than one there.
std::int64_t root(std::int64_t v) {
  auto r = static_cast<std::int64_t>(std::sqrt(static_cast<double>(v)));
  while (r * r > v) --r;
  while ((r + 1) * (r + 1) <= v) ++r;
  return r;
}

std::int64_t floor_quotient(std::int64_t a, std::int64_t b) {
  const std::int64_t q = a / b;
  return a % b < 0 ? q - 1 : q;
}

/// Of single precision: a distance from an edge or a plane is off by less than this part of the way to the
/// triangle's first corner and of its sides together, added up by axis. A dozen roundings, 2^-24 each, come
/// to half of it.
constexpr float kFloatSlack = 0x1p-19F;
/// A sum of squares is off by less than this part of it.
constexpr float kSquareSlack = 0x1p-20F;

constexpr float kDiagonal = 1.7320509F;  // of a cube, over its edge, and a little

/// Eight triangles as floats, in steps from their first corners. By edge: two vectors of unit length, along
/// it and in the plane away from the triangle, and where the second and the third begin.
struct TriangleRun {
  std::int32_t corner[3][kEight];
  float from[2][3][kEight], along[3][3][kEight], out[3][3][kEight], length[3][kEight];
  float normal[3][kEight];
  float room[kEight];  ///< by how much a distance may be off, but for the way to the first corner
};
struct NearTriangles {
  unsigned near, above;
};

constexpr std::uint32_t kNobody = DepthSearch::kNobody;

struct Run : TriangleRun {
  std::uint32_t number = kNobody;
};

/// A triangle as integers decide about it, with EXACTNESS's names for it.
struct Known {
  std::uint32_t id = kNobody;
  unsigned edges = 0;  ///< bits: those that are known
  struct Edge {
    Int3 from, along, out;      ///< u, e, m
    std::int64_t size, length;  ///< L, floor(√((v − u)·(v − u)))
  } edge[3];
};

struct Search {
  Int3 point;
  std::int64_t best = INT64_MAX;  ///< steps
  std::uint32_t triangle = kNobody, place = kNobody;

  /// A triangle whose distance is computed to be larger is further than the best one.
  float most() const { return best == INT64_MAX ? 0x1p50F : static_cast<float>(best + kRounding); }
};

/// Of the tree: a run at level 0; at level n what has eight boxes of level n - 1.
struct Node {
  std::uint32_t level, number;
};

/// A cube of space, and what of the tree a search in it begins with: nodes that have the nearest triangle of
/// every point in it.
struct Cube {
  static constexpr std::uint32_t kMost = 16;             // nodes: no more are looked at one by one (chosen)
  Int3 place{std::numeric_limits<std::int32_t>::min()};  ///< its lowest corner over its edge
  std::uint32_t count = 0;                               ///< of nodes; 0: not found yet
  std::array<Node, kMost> nodes;
  std::array<TriangleTree::Boxes, kMost / kEight> boxes;  ///< theirs
};

constexpr std::size_t kLevels = TriangleTree::kTurnedLevels + 1;  // of nodes: with turned boxes, and above

/// By level of a node, as descend() counts them, the distance from which on turned boxes tell more than they
/// cost: for runs any, for larger ones as much as they are long, for those that have none no distance.
std::array<float, kLevels + 1> turned_boxes_pay_from(const TriangleTree& tree) {
  std::array<float, kLevels + 1> out;
  out.fill(std::numeric_limits<float>::infinity());
  out[1] = 0;
  for (std::size_t level = 1; level < std::min(TriangleTree::kTurnedLevels, tree.level_begin.size());
       ++level) {
    const std::uint32_t boxes = tree.nodes(static_cast<std::uint32_t>(level));
    double sum = 0;  // of longest sides
    for (std::uint32_t box = 0; box < boxes; ++box) {
      const TriangleTree::Boxes& group = tree.boxes[tree.level_begin[level] + box / kEight];
      std::int32_t longest = 0;
      for (std::size_t k = 0; k < 3; ++k)
        longest = std::max(longest, group.high[k][box % kEight] - group.low[k][box % kEight]);
      sum += longest;
    }
    out[level + 1] = static_cast<float>(sum / boxes);
  }
  return out;
}

}  // namespace

struct alignas(kOwnLines) DepthSearch::Tables {
  // Chosen, at most so many: of a contact of 1,024 samples of either body few displace each other.
  static constexpr std::size_t kMostRuns = 2048;   // of triangles (2.3 MiB)
  static constexpr std::size_t kMostKnown = 4096;  // triangles (0.8 MiB)
  static constexpr std::size_t kMostCubes = 2048;  // cubes (1.0 MiB)
  const LatticeMesh& mesh;
  const TriangleTree& tree;
  std::array<float, kLevels + 1> turned_from = turned_boxes_pay_from(tree);
  std::vector<Run> runs;     ///< by run, where a newer one takes an older one's place
  std::vector<Known> known;  ///< by triangle, likewise
  std::vector<Cube> cubes;   ///< by place, likewise
  int cube_shift;            ///< 2^it: a cube's edge
  std::uint64_t looks = 0;

  Tables(const LatticeMesh& of_mesh, const TriangleTree& of_tree, std::int32_t spacing)
      : mesh(of_mesh),
        tree(of_tree),
        runs(table_size(of_tree.order.size() / kEight + 1, kMostRuns)),
        known(table_size(of_tree.order.size(), kMostKnown)),
        cubes(table_size(of_tree.order.size(), kMostCubes)),
        cube_shift(std::min(
            static_cast<int>(std::bit_width(static_cast<std::uint32_t>(std::max(spacing, 1)))) + 2, 30)) {}
  /// A power of two: no more than there are things to put into the table needs.
  static std::size_t table_size(std::size_t things, std::size_t most) {
    return std::bit_ceil(std::clamp<std::size_t>(things, 1, most));
  }
  /// Where in a table something is, or would be.
  template <class T>
  static T& place_in(std::vector<T>& table, std::uint32_t number) {
    return table[number & (table.size() - 1)];
  }
  const Run& run(std::uint32_t number);
  Known& know(std::uint32_t triangle);
  std::int64_t height_above(const Int3& point, std::uint32_t triangle) const;
  const Known::Edge& edge_of(std::uint32_t triangle, int edge);
  struct Passed {
    std::int64_t squared, at;
    int edge;
  };
  std::optional<Passed> least_edge(const Int3& point, std::uint32_t triangle, std::int64_t height);
  std::int64_t distance_to(const Int3& point, std::uint32_t triangle);
  Int3 way_out(const Int3& point, std::uint32_t triangle);
  void look_at(Search& search, std::uint32_t place, bool above);
  Cube& cube_at(const Int3& place);
};

Cube& DepthSearch::Tables::cube_at(const Int3& place) {
  const std::uint32_t mixed = static_cast<std::uint32_t>(place.x) * 73856093U ^
                              static_cast<std::uint32_t>(place.y) * 19349663U ^
                              static_cast<std::uint32_t>(place.z) * 83492791U;
  return place_in(cubes, mixed);
}

const Run& DepthSearch::Tables::run(std::uint32_t number) {
  Run& run = place_in(runs, number);
  if (run.number == number) return run;
  run.number = number;
  const std::size_t first = kEight * number, count = std::min(kEight, tree.order.size() - first);
  for (std::size_t i = 0; i < kEight; ++i) {
    const std::uint32_t id =
        tree.order[first + std::min(i, count - 1)];  // where there are fewer, the last one again
    const auto& [ia, ib, ic] = mesh.triangles[id];
    const Int3 corners[3] = {mesh.vertices[ia], mesh.vertices[ib], mesh.vertices[ic]};
    const Int3& n = mesh.unit_normal_q30[id];
    const double normal[3] = {n.x * 0x1p-30, n.y * 0x1p-30, n.z * 0x1p-30};
    double sides = 0;
    for (std::size_t edge = 0; edge < 3; ++edge) {
      const Int3 from = corners[edge] - corners[0], way = corners[edge == 2 ? 0 : edge + 1] - corners[edge];
      const double length = std::sqrt(static_cast<double>(product(way, way))),
                   along[3] = {way.x / length, way.y / length, way.z / length};
      for (std::size_t k = 0; k < 3; ++k) {
        const std::size_t l = (k + 1) % 3, m = (k + 2) % 3;
        if (edge != 0) run.from[edge - 1][k][i] = static_cast<float>(from[static_cast<int>(k)]);
        run.along[edge][k][i] = static_cast<float>(along[k]);
        run.out[edge][k][i] = static_cast<float>(along[l] * normal[m] - along[m] * normal[l]);
        sides += std::abs(static_cast<double>(way[static_cast<int>(k)]));
      }
      run.length[edge][i] = static_cast<float>(length);
    }
    for (std::size_t k = 0; k < 3; ++k) {
      run.corner[k][i] = corners[0][static_cast<int>(k)];
      run.normal[k][i] = static_cast<float>(normal[k]);
    }
    run.room[i] =
        8 + kFloatSlack * static_cast<float>(sides);  // 8: m is rounded by a step in 2^28, L likewise, n by
                                                      // 2^-31, and what is left is rounded down
  }
  return run;
}

Known& DepthSearch::Tables::know(std::uint32_t id) {
  Known& entry = place_in(known, id);
  if (entry.id != id) {
    entry.id = id;
    entry.edges = 0;
  }
  return entry;
}

std::int64_t DepthSearch::Tables::height_above(const Int3& point, std::uint32_t id) const {
  return std::abs((product(mesh.unit_normal_q30[id], point - mesh.corner(id, 0)) + (std::int64_t{1} << 29)) >>
                  30);
}

const Known::Edge& DepthSearch::Tables::edge_of(std::uint32_t id, int k) {
  Known& entry = know(id);
  Known::Edge& edge = entry.edge[k];
  if ((entry.edges >> k & 1) == 0) {
    edge.from = mesh.corner(id, k);
    const Int3 way = mesh.corner(id, k == 2 ? 0 : k + 1) - edge.from;
    edge.along = exact::normalise({way.x, way.y, way.z});
    const exact::Normal across = exact::cross(edge.along, mesh.unit_normal_q30[id]);
    edge.out = Int3(static_cast<std::int32_t>(across.x >> 30), static_cast<std::int32_t>(across.y >> 30),
                    static_cast<std::int32_t>(across.z >> 30));
    edge.size = root(product(edge.along, edge.along));
    edge.length = root(product(way, way));
    entry.edges |= 1U << k;
  }
  return edge;
}

/// The edge by whose way the distance is least, of several the first; none: the point is on no edge's outer
/// side.
std::optional<DepthSearch::Tables::Passed> DepthSearch::Tables::least_edge(const Int3& point,
                                                                           std::uint32_t id,
                                                                           std::int64_t height) {
  std::optional<Passed> least;
  for (int k = 0; k < 3; ++k) {
    const Known::Edge& edge = edge_of(id, k);
    const Int3 from = point - edge.from;
    const std::int64_t beyond = product(edge.out, from);
    if (beyond < edge.size) continue;  // ⌊beyond / size⌋ ≤ 0
    const std::int64_t side = beyond / edge.size, at = floor_quotient(product(edge.along, from), edge.size);
    const std::int64_t over = std::max({std::int64_t{0}, -at, at - edge.length});
    const std::int64_t squared = height * height + side * side + over * over;
    if (!least || squared < least->squared) least = {squared, at, k};
  }
  return least;
}

/// As EXACTNESS section 4 has it.
std::int64_t DepthSearch::Tables::distance_to(const Int3& point, std::uint32_t id) {
  const std::int64_t height = height_above(point, id);
  if (const auto least = least_edge(point, id, height)) return root(least->squared);
  // Beyond the end of a needle thinner than a step no side is above 0.
  std::int64_t squared = 0;
  for (int k = 0; k < 3; ++k) {
    const std::int64_t a = mesh.corner(id, 0)[k], b = mesh.corner(id, 1)[k], c = mesh.corner(id, 2)[k];
    const std::int64_t gap =
        std::max({std::min({a, b, c}) - point[k], point[k] - std::max({a, b, c}), std::int64_t{0}});
    squared += gap * gap;
  }
  const std::int64_t to_box = root(squared);
  return to_box > height + kRounding ? to_box : height;
}

/// Likewise; the triangle isn't next to the point.
Int3 DepthSearch::Tables::way_out(const Int3& point, std::uint32_t id) {
  const Int3& n = mesh.unit_normal_q30[id];
  const auto passed = least_edge(point, id, height_above(point, id));
  if (!passed) {
    const bool above = (product(n, point - mesh.corner(id, 0)) + (std::int64_t{1} << 29)) >= std::int64_t{1}
                                                                                                 << 30;
    return above ? -n : n;
  }
  const Known::Edge& edge = edge_of(id, passed->edge);
  const std::int64_t on = std::clamp(passed->at, std::int64_t{0}, edge.length);
  Int3 way;
  for (int c = 0; c < 3; ++c)
    way[c] =
        edge.from[c] + static_cast<std::int32_t>(floor_quotient(edge.along[c] * on, edge.size)) - point[c];
  way = exact::normalise({way.x, way.y, way.z});
  const std::int64_t size = root(product(way, way));
  for (int c = 0; c < 3; ++c)
    way[c] = static_cast<std::int32_t>(floor_quotient(way[c] * (std::int64_t{1} << 30), size));
  return way;
}

/// `above`: no edge has the point on its outer side.
void DepthSearch::Tables::look_at(Search& search, std::uint32_t place, bool above) {
  const std::uint32_t id = tree.order[place];
  const std::int64_t distance = above ? height_above(search.point, id) : distance_to(search.point, id);
  if (distance < search.best || (distance == search.best && id < search.triangle)) {
    search.best = distance;
    search.triangle = id;
    search.place = place;
  }
}

namespace {

namespace plain {
constexpr std::size_t kWidth = 4;
#include "compute/native/force/depth_simd.h"
}  // namespace plain
#if PALPATE_TWO_CODES
PALPATE_SECOND_CODE_BEGIN
#define PALPATE_SIGN_BITS
namespace second {
constexpr std::size_t kWidth = 8;
#include "compute/native/force/depth_simd.h"
}  // namespace second
#undef PALPATE_SIGN_BITS
PALPATE_SECOND_CODE_END
#endif

}  // namespace

DepthSearch::DepthSearch(const LatticeMesh& mesh, const TriangleTree& tree, std::int32_t spacing)
    : tables_(new Tables(mesh, tree, spacing)) {}
DepthSearch::DepthSearch() = default;
DepthSearch::DepthSearch(DepthSearch&&) noexcept = default;
DepthSearch& DepthSearch::operator=(DepthSearch&&) noexcept = default;
DepthSearch::~DepthSearch() = default;

std::uint64_t DepthSearch::looks() const { return tables_->looks; }

Int3 DepthSearch::way_out(const Int3& point, std::uint32_t triangle, std::uint32_t steps) {
  return steps < gpu::kLeastWay ? tables_->mesh.unit_normal_q30[triangle] : tables_->way_out(point, triangle);
}

std::uint64_t DepthSearch::bytes() const {
  return sizeof *tables_ + bytes_of(tables_->runs) + bytes_of(tables_->known) + bytes_of(tables_->cubes);
}

DepthSearch::Depth DepthSearch::below(const Int3& point, std::uint32_t guess) {
  Search search{.point = point};
  if (!tables_->tree.level_begin.empty()) {
#if PALPATE_TWO_CODES
    if (has_second_code())
      second::descend(*tables_, search, guess);
    else
#endif
      plain::descend(*tables_, search, guess);
  }
  return {static_cast<std::uint32_t>(search.best), search.triangle, search.place};
}

}  // namespace palpate

#include "compute/depth_search.h"

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <cstdlib>
#include <cstring>

#include "compute/host_exact.h"
#include "compute/processor.h"

namespace palpate {
namespace {

constexpr std::size_t kEight = TriangleTree::kEight;
constexpr std::int64_t kRounding = 16;   // steps by which a distance may be off, and more (EXACTNESS section 4)

std::int64_t product(const Int3& a, const Int3& b) { return std::int64_t{a.x} * b.x + std::int64_t{a.y} * b.y + std::int64_t{a.z} * b.z; }

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

/// Of single precision: a distance from an edge or a plane is off by less than this part of the way to the triangle's first corner and of its sides together, added up by
/// axis. A dozen roundings, 2^-24 each, come to half of it.
constexpr float kFloatSlack = 0x1p-19F;
/// A sum of squares is off by less than this part of it.
constexpr float kSquareSlack = 0x1p-20F;

/// Eight triangles as floats, in steps from their first corners. By edge: its first corner, and two vectors of unit length, along it and in the plane away from the triangle.
struct TriangleRun {
  std::int32_t corner[3][kEight];
  float from[3][3][kEight], along[3][3][kEight], out[3][3][kEight], length[3][kEight];
  float normal[3][kEight];
  float room[kEight];   ///< by how much a distance may be off, but for the way to the first corner
};
struct NearTriangles {
  unsigned near, above;
};

}  // namespace

struct DepthSearch::Run : TriangleRun {
  std::uint32_t number = kNobody;
};

/// A triangle as integers decide about it, with EXACTNESS's names for it.
struct DepthSearch::Known {
  std::uint32_t id = kNobody;
  unsigned edges = 0;              ///< bits: those that are known
  struct Edge {
    Int3 from, along, out;         ///< u, e, m
    std::int64_t size, length;     ///< L, floor(√((v − u)·(v − u)))
  } edge[3];
};

struct DepthSearch::Search {
  Int3 point;
  std::int64_t best = INT64_MAX;   ///< steps
  std::uint32_t triangle = kNobody, place = kNobody;

  /// A triangle whose distance is computed to be larger is further than the best one.
  float most() const { return best == INT64_MAX ? 0x1p50F : static_cast<float>(best + kRounding); }
};

namespace {

namespace plain {
constexpr std::size_t kWidth = 4;
#include "compute/depth_lanes.h"
}
#if PALPATE_TWO_CODES
PALPATE_SECOND_CODE_BEGIN
namespace second {
constexpr std::size_t kWidth = 8;
#include "compute/depth_lanes.h"
}
PALPATE_SECOND_CODE_END
#endif

struct PlainLanes {
  unsigned to_boxes(const TriangleTree::Boxes& boxes, const Int3& point, float limit, float* squared) const { return plain::to_boxes(boxes, point, limit, squared); }
  NearTriangles to_triangles(const TriangleRun& run, const Int3& point, float most, float* squared, float* slack) const {
    return plain::to_triangles(run, point, most, squared, slack);
  }
};
#if PALPATE_TWO_CODES
struct SecondLanes {
  unsigned to_boxes(const TriangleTree::Boxes& boxes, const Int3& point, float limit, float* squared) const { return second::to_boxes(boxes, point, limit, squared); }
  NearTriangles to_triangles(const TriangleRun& run, const Int3& point, float most, float* squared, float* slack) const {
    return second::to_triangles(run, point, most, squared, slack);
  }
};
#endif

}  // namespace

const DepthSearch::Run& DepthSearch::run(std::uint32_t number) {
  Run& run = runs_[number % kRuns];
  if (run.number == number) return run;
  run.number = number;
  const std::size_t first = kEight * number, count = std::min(kEight, tree_->order.size() - first);
  for (std::size_t i = 0; i < kEight; ++i) {
    const std::uint32_t id = tree_->order[first + std::min(i, count - 1)];   // where there are fewer, the last one again
    const auto& [ia, ib, ic] = mesh_->triangles[id];
    const Int3 corners[3] = {mesh_->vertices[ia], mesh_->vertices[ib], mesh_->vertices[ic]};
    const Int3& n = mesh_->unit_normal_q30[id];
    const double normal[3] = {n.x * 0x1p-30, n.y * 0x1p-30, n.z * 0x1p-30};
    double sides = 0;
    for (std::size_t edge = 0; edge < 3; ++edge) {
      const Int3 from = corners[edge] - corners[0], way = corners[edge == 2 ? 0 : edge + 1] - corners[edge];
      const double length = std::sqrt(static_cast<double>(product(way, way))), along[3] = {way.x / length, way.y / length, way.z / length};
      for (std::size_t k = 0; k < 3; ++k) {
        const std::size_t l = (k + 1) % 3, m = (k + 2) % 3;
        run.from[edge][k][i] = static_cast<float>(from[static_cast<int>(k)]);
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
    run.room[i] = 8 + kFloatSlack * static_cast<float>(sides);   // 8: m is rounded by a step in 2^28, L likewise, n by 2^-31, and what is left is rounded down
  }
  return run;
}

DepthSearch::Known& DepthSearch::know(std::uint32_t id) {
  Known& known = known_[id % kKnown];
  if (known.id == id) return known;
  known.id = id;
  known.edges = 0;
  return known;
}

std::int64_t DepthSearch::height_above(const Int3& point, std::uint32_t id) const {
  return std::abs((product(mesh_->unit_normal_q30[id], point - mesh_->corner(id, 0)) + (std::int64_t{1} << 29)) >> 30);
}

/// As EXACTNESS section 4 has it.
std::int64_t DepthSearch::distance_to(const Int3& point, std::uint32_t id) {
  Known& known = know(id);
  const std::int64_t height = height_above(point, id);
  std::int64_t least = -1;
  for (int k = 0; k < 3; ++k) {
    Known::Edge& edge = known.edge[k];
    if ((known.edges >> k & 1) == 0) {
      edge.from = mesh_->corner(id, k);
      const Int3 way = mesh_->corner(id, k == 2 ? 0 : k + 1) - edge.from;
      edge.along = exact::normalise({way.x, way.y, way.z});
      const exact::Normal across = exact::cross(edge.along, mesh_->unit_normal_q30[id]);
      edge.out = Int3(static_cast<std::int32_t>(across.x >> 30), static_cast<std::int32_t>(across.y >> 30), static_cast<std::int32_t>(across.z >> 30));
      edge.size = root(product(edge.along, edge.along));
      edge.length = root(product(way, way));
      known.edges |= 1U << k;
    }
    const Int3 from = point - edge.from;
    const std::int64_t beyond = product(edge.out, from);
    if (beyond < edge.size) continue;   // ⌊beyond / size⌋ ≤ 0
    const std::int64_t side = beyond / edge.size, at = floor_quotient(product(edge.along, from), edge.size);
    const std::int64_t over = std::max({std::int64_t{0}, -at, at - edge.length});
    const std::int64_t squared = height * height + side * side + over * over;
    if (least < 0 || squared < least) least = squared;
  }
  if (least >= 0) return root(least);
  // Beyond the end of a needle thinner than a step no side is above 0.
  std::int64_t squared = 0;
  for (int k = 0; k < 3; ++k) {
    const std::int64_t a = mesh_->corner(id, 0)[k], b = mesh_->corner(id, 1)[k], c = mesh_->corner(id, 2)[k];
    const std::int64_t gap = std::max({std::min({a, b, c}) - point[k], point[k] - std::max({a, b, c}), std::int64_t{0}});
    squared += gap * gap;
  }
  const std::int64_t to_box = root(squared);
  return to_box > height + kRounding ? to_box : height;
}

/// `above`: no edge has the point on its outer side.
void DepthSearch::look_at(Search& search, std::uint32_t place, bool above) {
  const std::uint32_t id = tree_->order[place];
  const std::int64_t distance = above ? height_above(search.point, id) : distance_to(search.point, id);
  if (distance < search.best || (distance == search.best && id < search.triangle)) {
    search.best = distance;
    search.triangle = id;
    search.place = place;
  }
}

template <class Lanes>
void DepthSearch::look_into(Search& search, std::uint32_t number, Lanes lanes) {
  const std::size_t first = kEight * number;
  const unsigned there = 0xFFU >> (kEight - std::min(kEight, tree_->order.size() - first));
  alignas(32) float squared[kEight], slack[kEight];
  const NearTriangles found = lanes.to_triangles(run(number), search.point, search.most(), squared, slack);
  for (unsigned near = there & found.near; near != 0;) {
    int nearest = std::countr_zero(near);
    for (unsigned rest = near & (near - 1); rest != 0; rest &= rest - 1)
      if (squared[std::countr_zero(rest)] < squared[nearest]) nearest = std::countr_zero(rest);
    near &= ~(1U << nearest);
    const float reach = search.most() + slack[nearest];
    if (squared[nearest] <= reach * reach * (1 + kSquareSlack)) look_at(search, static_cast<std::uint32_t>(first) + static_cast<std::uint32_t>(nearest), (found.above >> nearest & 1) != 0);
  }
}

/// From the root to runs, the nearest of each node first.
template <class Lanes>
void DepthSearch::descend(Search& search, std::uint32_t guess, Lanes lanes) {
  struct Open {
    std::uint32_t level, node;
    float squared;
  };
  std::array<Open, kEight * 12> open;   // a level leaves at most seven nodes waiting, and 8^12 triangles are more than a mesh can have
  const std::uint32_t seen = guess == kNobody ? kNobody : guess / static_cast<std::uint32_t>(kEight);
  if (seen != kNobody) look_into(search, seen, lanes);
  std::size_t count = 0;
  open[count++] = {static_cast<std::uint32_t>(tree_->level_begin.size()), 0, 0};   // level 0: a run; level n: a node of level n - 1's boxes
  alignas(32) float squared[kEight];
  while (count != 0) {
    const Open next = open[--count];
    const float most = search.most(), limit = most * most * (1 + kSquareSlack);
    if (next.squared > limit) continue;
    if (next.level == 0) {
      if (next.node != seen) look_into(search, next.node, lanes);
      continue;
    }
    const std::uint32_t first = static_cast<std::uint32_t>(kEight) * next.node;
    const unsigned there = 0xFFU >> (kEight - std::min<std::size_t>(kEight, tree_->nodes(next.level - 1) - first));
    std::size_t nearest = count;
    for (unsigned near = there & lanes.to_boxes(tree_->boxes[tree_->level_begin[next.level - 1] + next.node], search.point, limit, squared); near != 0; near &= near - 1) {
      const auto i = static_cast<std::uint32_t>(std::countr_zero(near));
      open[count] = {next.level - 1, first + i, squared[i]};
      if (squared[i] < open[nearest].squared) nearest = count;
      ++count;
    }
    if (nearest != count) std::swap(open[nearest], open[count - 1]);
  }
}

DepthSearch::DepthSearch(const LatticeMesh& mesh, const TriangleTree& tree) : mesh_(&mesh), tree_(&tree), runs_(kRuns), known_(kKnown) {}
DepthSearch::DepthSearch() = default;
DepthSearch::DepthSearch(const DepthSearch&) = default;
DepthSearch& DepthSearch::operator=(const DepthSearch&) = default;
DepthSearch::~DepthSearch() = default;

DepthSearch::Depth DepthSearch::below(const Int3& point, std::uint32_t guess) {
  Search search{.point = point};
  if (!tree_->level_begin.empty()) {
#if PALPATE_TWO_CODES
    if (has_second_code())
      descend(search, guess, SecondLanes());
    else
#endif
      descend(search, guess, PlainLanes());
  }
  return {static_cast<std::uint32_t>(search.best), search.triangle, search.place};
}

}  // namespace palpate

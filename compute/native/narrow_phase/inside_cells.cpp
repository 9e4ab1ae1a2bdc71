#include "compute/native/narrow_phase/inside_cells.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <utility>

#include "compute/native/broad_phase/turned_boxes.h"
#include "compute/scene/exact.h"

namespace palpate {
namespace {

using Block = BrickBits::Block;

constexpr std::size_t kMostVoxels = std::size_t{1} << 16;  // 8 MiB (chosen)
constexpr std::size_t kMostSpread = std::size_t{1} << 22;  // voxels of a grid, 32 MiB (chosen)
constexpr int kCells = InsideCells::kCells;
constexpr std::int32_t kPartsACell = kVoxelParts / kCells;
constexpr std::int32_t kLeastVoxel = 4 * kVoxelParts;  // steps: a part is then four of them at least
constexpr double kGrown =
    3;  // steps by which a cell is grown: doubles place a point within one, a perturbed point needs another

using Real3 = std::array<double, 3>;

double dot(const Real3& a, const Real3& b) { return a[0] * b[0] + a[1] * b[1] + a[2] * b[2]; }
Real3 cross(const Real3& a, const Real3& b) {
  return {a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]};
}
Real3 real(const Int3& v) { return {double(v.x), double(v.y), double(v.z)}; }
Real3 real(const exact::Normal& n) {
  return {static_cast<double>(n.x), static_cast<double>(n.y), static_cast<double>(n.z)};
}
double size_of(const Real3& n) { return std::abs(n[0]) + std::abs(n[1]) + std::abs(n[2]); }

/// Cells of a voxel along each axis, both among them.
struct Range {
  std::array<int, 3> first{0, 0, 0}, last{kCells - 1, kCells - 1, kCells - 1};
};

/// From anywhere to the middle of a voxel's first cell, `low` the way to the voxel's low corner.
Real3 to_middle(const Int3& low, double cell) {
  return {low.x + 0.5 * cell, low.y + 0.5 * cell, low.z + 0.5 * cell};
}

/// A convex set, as far as a few axes tell: axis[0] is at right angles to it, and along each of the others it
/// lies from `least` up.
struct Part {
  std::array<Real3, 4> axis;
  std::array<double, 4> least;
};

/// A bit each: cells, grown, that may meet the part; `from`: the way to the first cell's middle from where
/// the part's places are counted. Ways are below 2^30 and doubles off by less than 2^-20 of an axis's size,
/// far less than what a cell is grown by beyond need.
void add_met(const Part& part, const Real3& from, double cell, const Range& range, Block& out) {
  const double half = 0.5 * cell + kGrown;
  std::array<double, 4> at, reach;
  for (std::size_t i = 0; i < 4; ++i) {
    at[i] = dot(part.axis[i], from) - part.least[i];
    reach[i] = half * size_of(part.axis[i]);
  }
  for (int z = range.first[2]; z <= range.last[2]; ++z)
    for (int y = range.first[1]; y <= range.last[1]; ++y)
      for (int x = range.first[0]; x <= range.last[0]; ++x) {
        const Real3 way{cell * x, cell * y, cell * z};
        if (std::abs(at[0] + dot(part.axis[0], way)) > reach[0]) continue;
        if (at[1] + dot(part.axis[1], way) < -reach[1] || at[2] + dot(part.axis[2], way) < -reach[2] ||
            at[3] + dot(part.axis[3], way) < -reach[3])
          continue;
        out[static_cast<std::size_t>(z)] |= std::uint64_t{1} << (x + 8 * y);
      }
}

bool bounds_solid(const LatticeMesh& mesh, std::uint32_t id) {
  return (mesh.flags[id] & (kTriangleCollapsed | kTriangleSheet)) == 0;
}

/// A voxel's cells that a triangle which bounds a solid may touch: by its box there, its plane and its edges.
void add_touched(const LatticeMesh& mesh, const PartitionLookup& partition,
                 std::span<const std::uint8_t> all_boxes, const Int3& low, double cell,
                 std::uint32_t boundary, Block& out) {
  const auto list = partition.list(boundary);
  const std::size_t count = list.size();
  const std::uint8_t* boxes = &all_boxes[6 * std::size_t{partition.list_begin(boundary)}];
  for (std::size_t i = 0; i < count; ++i) {
    if (!bounds_solid(mesh, list[i])) continue;
    Range range;
    for (std::size_t k = 0; k < 3; ++k) {
      // A part to spare on either side, and a box of parts reaches a part further than its high.
      range.first[k] = std::max((boxes[k * count + i] - 1) / kPartsACell, 0);
      range.last[k] = std::min((boxes[(k + 3) * count + i] + 2) / kPartsACell, kCells - 1);
    }
    const exact::Corners t{mesh.corner(list[i], 0), mesh.corner(list[i], 1), mesh.corner(list[i], 2)};
    Part part;
    part.axis[0] = real(exact::raw_normal(t));
    part.least[0] = 0;
    for (std::size_t e = 0; e < 3; ++e) {  // inwards of each edge
      part.axis[e + 1] = cross(part.axis[0], real(t[(e + 1) % 3] - t[e]));
      part.least[e + 1] = dot(part.axis[e + 1], real(t[e] - t[0]));
    }
    add_met(part, to_middle(low - t[0], cell), cell, range, out);
  }
}

/// Whether the way from p to q may meet the cube [low, low + side]. Separating axes in doubles: products are
/// below 2^60 and off by less than 2^8 of 2^60, and each is given a step's worth of the way's length more,
/// 2^20 times as much.
bool may_meet(const Int3& p, const Int3& q, const Int3& low, std::int32_t side) {
  const double half = 0.5 * side + 2;
  double middle[3], way[3];  // from the cube's centre, half the way
  for (std::size_t k = 0; k < 3; ++k) {
    const int axis = static_cast<int>(k);
    middle[k] = 0.5 * (double(p[axis]) + q[axis]) - low[axis] - 0.5 * side;
    way[k] = 0.5 * (double(q[axis]) - p[axis]);
    if (std::abs(middle[k]) > half + std::abs(way[k])) return false;
  }
  for (std::size_t k = 0; k < 3; ++k) {
    const std::size_t u = (k + 1) % 3, v = (k + 2) % 3;
    if (std::abs(middle[u] * way[v] - middle[v] * way[u]) > half * (std::abs(way[u]) + std::abs(way[v])))
      return false;
  }
  return true;
}

/// An edge of listed triangles.
struct Edge {
  std::uint32_t low, high;  ///< vertices
  int way;                  ///< +1 from low to high
  bool operator<(const Edge& o) const { return low != o.low ? low < o.low : high < o.high; }
};

/// A voxel's cells from which an edge that does not cancel, of what the voxel lists, may be just passed on
/// the way to the middle: the edge's shadow, as the middle sees it. `edges`: room.
void add_shadows(const LatticeMesh& mesh, const PartitionLookup& partition, const Int3& voxel, double cell,
                 std::uint32_t boundary, std::vector<Edge>& edges, Block& out) {
  edges.clear();
  for (const std::uint32_t id : partition.list(boundary)) {
    if (!bounds_solid(mesh, id)) continue;
    const auto& vertices = mesh.triangles[id];
    for (std::size_t k = 0; k < 3; ++k) {
      const std::uint32_t a = vertices[k], b = vertices[(k + 1) % 3];
      edges.push_back({std::min(a, b), std::max(a, b), a < b ? 1 : -1});
    }
  }
  std::sort(edges.begin(), edges.end());
  const std::int32_t size = partition.grid().size;
  const Int3 low = partition.grid().origin + size * voxel, middle = low + Int3(size / 2);
  for (std::size_t i = 0; i < edges.size();) {
    const Edge& edge = edges[i];
    int sum = 0;
    for (; i < edges.size() && edges[i].low == edge.low && edges[i].high == edge.high; ++i)
      sum += edges[i].way;
    // A way from the middle leaves the voxel once: so does the shadow, and what lies outside has none within.
    if (sum == 0 || !may_meet(mesh.vertices[edge.low], mesh.vertices[edge.high], low, size)) continue;
    const Int3 to_u = mesh.vertices[edge.low] - middle, to_v = mesh.vertices[edge.high] - middle;
    const exact::Normal normal = exact::cross(to_u, to_v);
    if (normal == exact::Normal{}) {  // a line through the middle hides what a perturbation makes of it
      out.fill(~std::uint64_t{0});
      return;
    }
    // middle + a u + b v with a, b ≥ 0 and a + b ≥ 1.
    const Real3 n = real(normal), u = real(to_u), v = real(to_v);
    const Part shadow{{n, cross(n, u), cross(v, n), cross(real(to_v - to_u), n)}, {0, 0, 0, dot(n, n)}};
    add_met(shadow, to_middle(low - middle, cell), cell, {}, out);
  }
}

/// Of a voxel's cells those that can be reached from one of them through faces without leaving `among`.
Block reached(const Block& from, const Block& among) {
  constexpr std::uint64_t kFirstX = 0x0101010101010101;
  Block out = from;
  for (bool more = true; more;) {
    more = false;
    for (std::size_t z = 0; z < 8; ++z) {
      std::uint64_t row = out[z] | (z > 0 ? out[z - 1] : 0) | (z < 7 ? out[z + 1] : 0);
      row |= (out[z] << 1 & ~kFirstX) | (out[z] >> 1 & ~(kFirstX << 7)) | out[z] << 8 | out[z] >> 8;
      row &= among[z];
      more |= row != out[z];
      out[z] = row;
    }
  }
  return out;
}

}  // namespace

InsideCells::InsideCells(const LatticeMesh& mesh, const PartitionView& view,
                         std::span<const std::uint8_t> boxes, const Ask& ask)
    : origin_(view.grid.origin), size_(view.grid.size), per_cell_(double(kCells) / view.grid.size) {
  const std::size_t voxels = view.grid.boundary_voxels;
  if (size_ < kLeastVoxel || voxels > kMostVoxels) return;
  const PartitionLookup partition(view);
  const double cell = double(size_) / kCells;
  std::vector<Edge> edges;
  voxels_.resize(voxels);
  for (std::uint32_t boundary = 0; boundary < voxels; ++boundary) {
    const Int3 voxel = view.boundary_voxel(boundary), low = origin_ + size_ * voxel;
    Voxel& cells = voxels_[boundary];
    add_touched(mesh, partition, boxes, low, cell, boundary, cells.touched);
    add_shadows(mesh, partition, voxel, cell, boundary, edges, cells.touched);
    Block left;
    for (std::size_t z = 0; z < 8; ++z) left[z] = ~cells.touched[z];
    for (std::size_t z = 0; z < 8; ++z)
      while (left[z] != 0) {
        const int bit = std::countr_zero(left[z]);
        Block first{};
        first[z] = std::uint64_t{1} << bit;
        const Block together = reached(first, left);
        const Int3 middle = low + Int3(static_cast<std::int32_t>(((bit & 7) + 0.5) * cell),
                                       static_cast<std::int32_t>(((bit >> 3) + 0.5) * cell),
                                       static_cast<std::int32_t>((static_cast<double>(z) + 0.5) * cell));
        const std::uint64_t answer = ask(middle, voxel, boundary) ? ~std::uint64_t{0} : 0;
        for (std::size_t k = 0; k < 8; ++k) {
          cells.inside[k] |= together[k] & answer;
          left[k] &= ~together[k];
        }
      }
  }
}

bool InsideCells::spread(const PartitionView& partition, BrickBits& may, BrickBits& all) const {
  const std::size_t bricks = brick_count(partition.grid.bricks), voxels = 512 * bricks;
  if (voxels_.empty() || voxels > kMostSpread) return false;
  const PartitionLookup classes(partition);
  const Int3 size = 8 * partition.grid.bricks;
  std::vector<std::uint32_t> slots;
  slots.reserve(voxels);
  Int3 v;
  for (v.z = 0; v.z < size.z; ++v.z)
    for (v.y = 0; v.y < size.y; ++v.y)
      for (v.x = 0; v.x < size.x; ++v.x) {
        const PartitionLookup::Voxel at = classes.at(v);
        slots.push_back(at.boundary != gpu::kNoVoxel     ? at.boundary
                        : at.kind == gpu::kVoxelInternal ? gpu::kBrickInternal
                                                         : gpu::kBrickExternal);
      }
  std::vector<Block> blocks(voxels_.size());
  for (std::size_t i = 0; i < blocks.size(); ++i)
    for (std::size_t z = 0; z < 8; ++z) blocks[i][z] = voxels_[i].inside[z] | voxels_[i].touched[z];
  may.make(size, slots, blocks);
  for (std::size_t i = 0; i < blocks.size(); ++i)
    for (std::size_t z = 0; z < 8; ++z) blocks[i][z] = voxels_[i].inside[z] & ~voxels_[i].touched[z];
  all.make(size, std::move(slots), blocks);
  return true;
}

}  // namespace palpate

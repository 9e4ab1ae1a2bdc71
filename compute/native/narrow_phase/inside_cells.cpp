#include "compute/native/narrow_phase/inside_cells.h"

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>

#include "compute/native/broad_phase/turned_boxes.h"
#include "compute/scene/exact.h"

namespace palpate {
namespace {

constexpr std::size_t kMostVoxels = std::size_t{1} << 16;  // 8 MiB (chosen)
constexpr int kSide = 4;                                   // InsideCells::kSide
constexpr std::int32_t kPartsACell = kVoxelParts / (2 * kSide);
constexpr std::int32_t kLeastVoxel = 4 * kVoxelParts;  // steps: a part is then four of them at least
constexpr double kGrown =
    3;  // steps by which a cell is grown: doubles place a point within one, a perturbed point needs another

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

/// A bit each: which cells of an octant a triangle may touch, by its box there and its plane.
std::uint64_t touched_cells(const LatticeMesh& mesh, const HostPartition& partition,
                            std::span<const std::uint8_t> all_boxes, std::uint32_t octant, const Int3& voxel,
                            std::uint32_t boundary) {
  const gpu::GridConstants& grid = partition.grid();
  const auto list = partition.list(boundary);
  const std::size_t count = list.size();
  const std::uint8_t* boxes = &all_boxes[6 * std::size_t{partition.list_begin(boundary)}];
  const double cell = double(grid.size) / (2 * kSide), half = 0.5 * cell + kGrown;
  std::uint64_t out = 0;
  for (std::size_t i = 0; i < count; ++i) {
    if ((mesh.flags[list[i]] & kTriangleCollapsed) != 0) continue;
    int first[3], last[3];
    bool meets = true;
    for (std::size_t k = 0; k < 3; ++k) {
      // A part to spare on either side, and a box of parts reaches a part further than its high.
      const int begin = (octant >> k & 1) != 0 ? kSide : 0;
      first[k] = std::max((boxes[k * count + i] - 1) / kPartsACell - begin, 0);
      last[k] = std::min((boxes[(k + 3) * count + i] + 2) / kPartsACell - begin, kSide - 1);
      meets = meets && first[k] <= last[k];
    }
    if (!meets) continue;
    // Distances are below 2^30 and doubles off by less than 2^-20 of the normal's size, far less than what a
    // cell is grown by beyond need.
    const exact::Corners corners{mesh.corner(list[i], 0), mesh.corner(list[i], 1), mesh.corner(list[i], 2)};
    const exact::Normal n = exact::raw_normal(corners);
    const double normal[3] = {static_cast<double>(n.x), static_cast<double>(n.y), static_cast<double>(n.z)};
    const double reach = half * (std::abs(normal[0]) + std::abs(normal[1]) + std::abs(normal[2]));
    double from = 0;  // of the octant's first cell's middle
    for (std::size_t k = 0; k < 3; ++k) {
      const int axis = static_cast<int>(k);
      from += normal[k] * (grid.origin[axis] + double(grid.size) * voxel[axis] +
                           ((octant >> k & 1) != 0 ? kSide * cell : 0) + 0.5 * cell - corners[0][axis]);
    }
    for (int z = first[2]; z <= last[2]; ++z)
      for (int y = first[1]; y <= last[1]; ++y)
        for (int x = first[0]; x <= last[0]; ++x)
          if (std::abs(from + cell * (normal[0] * x + normal[1] * y + normal[2] * z)) <= reach)
            out |= std::uint64_t{1} << (x + kSide * y + kSide * kSide * z);
  }
  return out;
}

/// A bit each: in which octants what the voxel lists may have an edge that does not cancel. Elsewhere the
/// answer changes only where a triangle is crossed: the voxel's middle, from where crossings are counted, is
/// a corner of the octant, and so two ways to it enclose nothing but what lies in the octant.
unsigned open_octants(const LatticeMesh& mesh, const HostPartition& partition, const Int3& voxel,
                      std::uint32_t boundary) {
  constexpr unsigned kAll = 0xFF;
  constexpr std::size_t kMostEdges = 384;  // of longer lists nothing is known
  struct Edge {
    std::uint32_t low, high;
    int way;
  };
  std::array<Edge, kMostEdges> edges;
  std::size_t count = 0;
  for (const std::uint32_t id : partition.list(boundary)) {
    if ((mesh.flags[id] & (kTriangleCollapsed | kTriangleSheet)) != 0) continue;
    const auto& vertices = mesh.triangles[id];
    for (std::size_t k = 0; k < 3; ++k) {
      const std::uint32_t a = vertices[k], b = vertices[(k + 1) % 3];
      if (count == kMostEdges) return kAll;
      edges[count++] = {std::min(a, b), std::max(a, b), a < b ? 1 : -1};
    }
  }
  std::sort(edges.begin(), edges.begin() + static_cast<std::ptrdiff_t>(count),
            [](const Edge& a, const Edge& b) { return a.low != b.low ? a.low < b.low : a.high < b.high; });
  const std::int32_t size = partition.grid().size, half = size / 2;
  const Int3 low = partition.grid().origin + size * voxel;
  unsigned out = 0;
  for (std::size_t i = 0; i < count;) {
    int sum = 0;
    const Edge& edge = edges[i];
    for (; i < count && edges[i].low == edge.low && edges[i].high == edge.high; ++i) sum += edges[i].way;
    if (sum == 0) continue;
    for (int octant = 0; octant < 8; ++octant)
      if (may_meet(mesh.vertices[edge.low], mesh.vertices[edge.high],
                   low + half * Int3(octant & 1, octant >> 1 & 1, octant >> 2), half))
        out |= 1u << octant;
  }
  return out;
}

/// Of an octant's cells those that can be reached from one of them through faces without leaving `among`.
std::uint64_t reached(std::uint64_t from, std::uint64_t among) {
  constexpr std::uint64_t kFirstX = 0x1111111111111111, kFirstY = 0x000F000F000F000F;
  for (std::uint64_t before = 0; from != before;) {
    before = from;
    from |= ((from << 1 & ~kFirstX) | (from >> 1 & ~(kFirstX << 3)) | (from << 4 & ~kFirstY) |
             (from >> 4 & ~(kFirstY << 12)) | from << 16 | from >> 16) &
            among;
  }
  return from;
}

}  // namespace

InsideCells::InsideCells(const LatticeMesh& mesh, const PartitionView& view,
                         std::span<const std::uint8_t> boxes, const Ask& ask)
    : origin_(view.grid.origin), size_(view.grid.size), per_cell_(2.0 * kSide / view.grid.size) {
  const std::size_t voxels = view.grid.boundary_voxels;
  if (size_ < kLeastVoxel || voxels > kMostVoxels) return;
  const HostPartition partition(view);
  octants_.resize(8 * voxels);
  for (std::uint32_t boundary = 0; boundary < voxels; ++boundary) {
    const Int3 voxel = view.boundary_voxel(boundary);
    const unsigned open = open_octants(mesh, partition, voxel, boundary);
    for (std::uint32_t octant = 0; octant < 8; ++octant) {
      Octant& cells = octants_[8 * std::size_t{boundary} + octant];
      cells.touched = (open >> octant & 1) != 0
                          ? ~std::uint64_t{0}
                          : touched_cells(mesh, partition, boxes, octant, voxel, boundary);
      for (std::uint64_t left = ~cells.touched; left != 0;) {
        const int first = std::countr_zero(left);
        const std::uint64_t together = reached(std::uint64_t{1} << first, left);
        Int3 middle = origin_ + size_ * voxel;
        for (int k = 0; k < 3; ++k)
          middle[k] +=
              static_cast<std::int32_t>(((octant >> k & 1) * kSide + (first >> 2 * k & 3) + 0.5) / per_cell_);
        if (ask(middle, voxel, boundary)) cells.inside |= together;
        left &= ~together;
      }
    }
  }
}

}  // namespace palpate

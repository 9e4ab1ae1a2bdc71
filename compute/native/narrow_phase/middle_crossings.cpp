#include "compute/native/narrow_phase/middle_crossings.h"

#include <cmath>
#include <cstring>

#include "compute/native/processor.h"
#include "compute/scene/exact.h"

namespace palpate {
namespace {

constexpr std::size_t kMostRows = std::size_t{1} << 15;  // 14 MiB (chosen)

namespace plain {
constexpr std::size_t kWidth = 4;
#include "compute/native/narrow_phase/middle_crossings_simd.h"
}  // namespace plain
#if PALPATE_TWO_CODES
PALPATE_SECOND_CODE_BEGIN
namespace second {
constexpr std::size_t kWidth = 8;
#include "compute/native/narrow_phase/middle_crossings_simd.h"
}  // namespace second
PALPATE_SECOND_CODE_END
#endif

/// A row of `to`: `times` the normal, made so long that its product with any way from the middle is below 1.
/// Returns what it was multiplied by.
double put(const exact::Normal& normal, double times, double half, float (&to)[3][MiddleCrossings::kEight],
           std::size_t lane) {
  const double n[3] = {static_cast<double>(normal.x), static_cast<double>(normal.y),
                       static_cast<double>(normal.z)};
  const double size = half * (std::abs(n[0]) + std::abs(n[1]) + std::abs(n[2]));
  const double scale = size == 0 ? 0 : times / size;  // of an edge in line with the middle nobody is sure
  for (std::size_t k = 0; k < 3; ++k) to[k][lane] = static_cast<float>(scale * n[k]);
  return scale;
}

}  // namespace

MiddleCrossings::MiddleCrossings(const LatticeMesh& mesh, const PartitionView& view) {
  const PartitionLookup partition(view);
  const std::uint32_t voxels = view.grid.boundary_voxels;
  const std::int32_t half = view.grid.size / 2;
  const auto bounds_solid = [&](std::uint32_t id) {
    return (mesh.flags[id] & (kTriangleCollapsed | kTriangleSheet)) == 0;
  };
  std::vector<std::uint32_t> begin{0};
  begin.reserve(voxels + 1);
  for (std::uint32_t boundary = 0; boundary < voxels; ++boundary) {
    std::size_t count = 0;
    for (const std::uint32_t id : partition.list(boundary)) count += bounds_solid(id) ? 1u : 0u;
    begin.push_back(begin.back() + static_cast<std::uint32_t>((count + kEight - 1) / kEight));
    if (begin.back() > kMostRows) return;
  }
  begin_ = std::move(begin);
  rows_.resize(begin_.back());  // what is left over crosses nothing
  for (Rows& rows : rows_)
    for (float& offset : rows.offset) offset = -1;
  for (std::uint32_t boundary = 0; boundary < voxels; ++boundary) {
    const Int3 middle = view.grid.origin + view.grid.size * view.boundary_voxel(boundary) + Int3(half);
    std::size_t i = 0;
    for (const std::uint32_t id : partition.list(boundary)) {
      if (!bounds_solid(id)) continue;
      Rows& rows = rows_[begin_[boundary] + i / kEight];
      const std::size_t lane = i++ % kEight;
      const exact::Corners t{mesh.corner(id, 0), mesh.corner(id, 1), mesh.corner(id, 2)};
      const exact::Normal normal = exact::raw_normal(t);
      const int facing = -exact::plane_ahead(normal, middle, t[0]);  // of a point beyond the plane
      const double scale = put(normal, -facing, half, rows.plane, lane);
      rows.offset[lane] = static_cast<float>(-scale * static_cast<double>(exact::dot(normal, t[0] - middle)));
      for (std::size_t e = 0; e < 3; ++e)
        put(exact::cross(t[e] - middle, t[(e + 1) % 3] - middle), -facing, half, rows.edge[e], lane);
      rows.way[lane] = facing;
    }
  }
}

MiddleCrossings::Net MiddleCrossings::crossed(const Int3& from_middle, std::uint32_t boundary) const {
  const float at[3] = {static_cast<float>(from_middle.x), static_cast<float>(from_middle.y),
                       static_cast<float>(from_middle.z)};
  const Rows *rows = rows_.data() + begin_[boundary], *end = rows_.data() + begin_[boundary + 1];
#if PALPATE_TWO_CODES
  if (has_second_code()) return second::crossed(rows, end, at);
#endif
  return plain::crossed(rows, end, at);
}

}  // namespace palpate

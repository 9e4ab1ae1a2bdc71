#include "cpu_ref/heights.h"

#include <algorithm>

#include "cpu_ref/ray.h"

namespace palpate::cpu_ref {

std::optional<std::uint32_t> height(const Frame& frame, const Area& area, const Int3& origin,
                                    const Int3& direction) {
  std::vector<std::uint32_t> candidates;
  frame.tool_tree.along_ray(origin, direction, candidates);
  std::optional<std::uint32_t> least;
  const std::vector<std::uint32_t>& own = area.out.mobile_ids;
  for (const std::uint32_t m : candidates) {
    if (!std::binary_search(own.begin(), own.end(), m)) continue;  // another area's, or nobody's
    if (const auto crossing = ray_crosses_at(origin, direction, frame.tool[m]);
        crossing && (!least || crossing->height < *least))
      least = crossing->height;
  }
  return least;
}

void measure_heights(const Frame& frame, Area& area) {
  if (area.out.direction == Int3(0)) return;
  const Int3 down = -area.out.direction;
  const LatticeMesh& mesh = frame.mockup();
  for (const std::uint32_t s : area.out.static_ids) {
    const Long3 sum = Long3(mesh.corner(s, 0)) + Long3(mesh.corner(s, 1)) + Long3(mesh.corner(s, 2));
    Int3 centroid;
    for (int k = 0; k < 3; ++k)
      centroid[k] = static_cast<std::int32_t>(floor_divide(sum[k], std::int64_t{3}));
    const auto found = height(frame, area, centroid, down);
    if (!found) continue;
    area.out.rays += 1;
    area.out.max_height = std::max(area.out.max_height, *found);
    area.out.height_sum += *found;
  }
}

void sum_voxels(const Frame& frame, Area& area) {
  const Partition& partition = frame.scene.mockup;
  for (const std::uint64_t number : frame.touched_boundary) {
    const auto listed = partition.listed(number);
    const bool of_area = std::any_of(listed.begin(), listed.end(), [&](std::uint32_t s) {
      return std::binary_search(area.out.static_ids.begin(), area.out.static_ids.end(), s);
    });
    if (!of_area) continue;
    const Int3 centre = partition.centre(partition.voxel(number));
    for (int k = 0; k < 3; ++k) area.out.voxel_sum[static_cast<std::size_t>(k)] += centre[k];
    ++area.out.voxel_count;
  }
}

}  // namespace palpate::cpu_ref

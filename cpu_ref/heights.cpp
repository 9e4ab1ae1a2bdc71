#include "cpu_ref/heights.h"

#include <algorithm>

namespace palpate::cpu_ref {

std::vector<Crossing> tool_crossings(const Frame& frame, const Int3& origin, const Int3& direction) {
  std::vector<std::uint32_t> candidates;
  frame.tool_tree.along_ray(origin, direction, candidates);
  std::vector<Crossing> crossings;
  for (const std::uint32_t m : candidates)
    if (const auto crossing = ray_crosses_at(origin, direction, frame.tool[m])) crossings.push_back(*crossing);
  return crossings;
}

std::optional<std::uint32_t> height(const Frame& frame, const Int3& origin, const Int3& direction) {
  std::vector<Crossing> crossings = tool_crossings(frame, origin, direction);
  if (crossings.empty()) return std::nullopt;
  std::sort(crossings.begin(), crossings.end(), [](const Crossing& a, const Crossing& b) { return a.height < b.height; });
  if (!frame.scene.refined() || frame.scene.tool_open()) return crossings.front().height;

  // From the far end back: `beyond` is the winding after all crossings of one height. The last height with 0 seen is the
  // smallest, and the farthest crossing has nothing beyond it.
  std::uint32_t result = crossings.back().height;
  int beyond = 0;
  for (std::size_t end = crossings.size(); end > 0;) {
    const std::uint32_t here = crossings[end - 1].height;
    if (beyond == 0) result = here;
    for (; end > 0 && crossings[end - 1].height == here; --end) beyond += crossings[end - 1].sign;
  }
  return result;
}

void add_height(Area& area, std::uint32_t height, std::uint32_t weight_q30, const Int3& sample) {
  ContactArea& out = area.out;
  const auto product = static_cast<std::int64_t>((std::uint64_t{height} * weight_q30) >> 30);   // H ≤ 2^31, w < 2^31
  out.rays += 1;
  out.max_height = std::max(out.max_height, height);
  out.weight_sum += weight_q30;
  out.height_sum += product;
  for (int k = 0; k < 3; ++k) {
    const std::int64_t moment = product * sample[k];   // within 2^32 · 2^28
    WideSum& sum = out.moment[static_cast<std::size_t>(k)];
    sum.low += moment & 0xFFFFFFFF;
    sum.high += moment >> 32;
  }
}

void measure_heights(const Frame& frame, Area& area) {
  if (area.out.direction == Int3(0)) return;
  const Int3 down = -area.out.direction;
  const LatticeMesh& mesh = frame.mockup();
  if (frame.scene.refined()) {
    for (const Sample& sample : area.counting) {
      const auto found = height(frame, sample.point, down);
      if (!found) continue;
      area.rays.push_back({sample.point, *found});
      add_height(area, *found, mesh.sample_weight_q30[sample.triangle], sample.point);
    }
    return;
  }
  for (const std::uint32_t s : area.out.static_ids) {   // `paper`: the triangles' centroids
    const Long3 sum = Long3(mesh.corner(s, 0)) + Long3(mesh.corner(s, 1)) + Long3(mesh.corner(s, 2));
    Int3 centroid;
    for (int k = 0; k < 3; ++k) centroid[k] = static_cast<std::int32_t>(floor_divide(sum[k], std::int64_t{3}));
    if (const auto hit = height(frame, centroid, down)) add_height(area, *hit, std::uint32_t{1} << 30, centroid);
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

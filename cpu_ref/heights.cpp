#include "cpu_ref/heights.h"

#include <algorithm>
#include <cstdlib>
#include <tuple>

#include "cpu_ref/direction.h"

namespace palpate::cpu_ref {

std::vector<Crossing> tool_crossings(const Frame& frame, const Int3& origin, const Int3& direction, std::vector<std::uint32_t>* triangles) {
  std::vector<std::uint32_t> candidates;
  frame.tool_tree.along_ray(origin, direction, candidates);
  std::vector<Crossing> crossings;
  for (const std::uint32_t m : candidates)
    if (const auto crossing = ray_crosses_at(origin, direction, frame.tool[m])) {
      crossings.push_back(*crossing);
      if (triangles != nullptr) triangles->push_back(m);
    }
  return crossings;
}

namespace {

/// Of the triangles that are crossed at that height, the smallest normal in the order of components.
Int3 normal_at(const Frame& frame, const std::vector<std::uint32_t>& triangles, const std::vector<Crossing>& crossings, std::uint32_t height) {
  std::optional<Int3> least;
  for (std::size_t i = 0; i < crossings.size(); ++i) {
    if (crossings[i].height != height) continue;
    const Int3 m = normalise(frame.tool[triangles[i]].normal);
    if (!least || std::tie(m.x, m.y, m.z) < std::tie(least->x, least->y, least->z)) least = m;
  }
  return *least;
}

/// How a sample fades in, at t < 3 in Q18 (EXACTNESS section 7).
struct Fade {
  std::int64_t twice_weight;   ///< 2φ, Q36
  std::int64_t twice_slope;    ///< 2φ', Q18
  std::int64_t twelve_height;  ///< 12ν, Q54
};
Fade fade_at(std::int64_t t) {
  constexpr std::int64_t k1 = 1 << 18, k2 = k1 * k1;
  if (t < k1) return {2 * t * t, 4 * t, 8 * t * t * t};
  if (t < 2 * k1) return {10 * k1 * t - 5 * k2 - 3 * t * t, 10 * k1 - 6 * t, 5 * k2 * k1 - 30 * k2 * t + 45 * k1 * t * t - 12 * t * t * t};
  return {11 * k2 - 6 * k1 * t + t * t, 2 * t - 6 * k1, 66 * k2 * t - 27 * k2 * k1 - 27 * k1 * t * t + 4 * t * t * t};
}

constexpr std::uint32_t kLeastFade = 8;

/// H_0: how much further, in height, the next sample of the grid lies on the same two faces.
std::uint32_t fade_height(const Frame& frame, const Sample& sample, const Int3& direction, const Int3& exit_normal) {
  const LatticeMesh& mesh = frame.mockup();
  const std::int64_t spacing = frame.scene.geometry->sample_spacing;
  const Int3 n = mesh.unit_normal_q30[sample.triangle], m = exit_normal;
  const int k = mesh.sample_axis[sample.triangle];
  std::int64_t along = 0;   // m along a grid step on the face, by the spacing; below 2^32
  for (const int w : {(k + 1) % 3, (k + 2) % 3}) {
    const std::int64_t a = std::int64_t{m[w]} * n[k] - std::int64_t{m[k]} * n[w];   // within 2^60
    along = std::max<std::int64_t>(along, std::llabs(a) / std::llabs(std::int64_t{n[k]}));
  }
  const std::int64_t out = std::llabs(std::int64_t{m.x} * direction.x + std::int64_t{m.y} * direction.y + std::int64_t{m.z} * direction.z) >> 28;
  const Int3 size = glm::abs(direction);
  const std::int64_t most = std::min((spacing << 32) / std::max({size.x, size.y, size.z}), std::int64_t{1} << 30);   // spacing ≤ 2^28
  return static_cast<std::uint32_t>(out == 0 ? most : std::min(most, 4 * spacing * along / out));
}

}  // namespace

std::optional<Exit> height(const Frame& frame, const Int3& origin, const Int3& direction) {
  std::vector<std::uint32_t> triangles;
  std::vector<Crossing> crossings = tool_crossings(frame, origin, direction, &triangles);
  if (crossings.empty()) return std::nullopt;
  std::vector<Crossing> sorted = crossings;
  std::sort(sorted.begin(), sorted.end(), [](const Crossing& a, const Crossing& b) { return a.height < b.height; });
  std::uint32_t result = sorted.front().height;
  if (!frame.scene.tool_open()) {
    // From the far end back: `beyond` is the winding after all crossings of one height. The last height with 0 seen is the
    // smallest, and the farthest crossing has nothing beyond it.
    result = sorted.back().height;
    int beyond = 0;
    for (std::size_t end = sorted.size(); end > 0;) {
      const std::uint32_t here = sorted[end - 1].height;
      if (beyond == 0) result = here;
      for (; end > 0 && sorted[end - 1].height == here; --end) beyond += sorted[end - 1].sign;
    }
  }
  return Exit{result, normal_at(frame, triangles, crossings, result)};
}

void add_height(Area& area, std::uint32_t height, std::uint32_t weight_q30, const Int3& sample, std::uint32_t fade) {
  ContactArea& out = area.out;
  const auto product = static_cast<std::int64_t>((std::uint64_t{height} * weight_q30) >> 30);   // H ≤ 2^31, w < 2^31
  out.rays += 1;
  out.max_height = std::max(out.max_height, height);
  out.height_sum += product;
  for (int k = 0; k < 3; ++k) {
    const std::int64_t moment = product * sample[k];   // within 2^32 · 2^28
    WideSum& sum = out.moment[static_cast<std::size_t>(k)];
    sum.low += moment & 0xFFFFFFFF;
    sum.high += moment >> 32;
  }

  const std::int64_t whole = weight_q30, h = height;
  std::int64_t weight = whole, slope = whole, faded = h * whole >> 10;   // faded: w·H, Q20
  if (fade >= kLeastFade && height < 3 * std::uint64_t{fade}) {
    const std::int64_t t = (h << 18) / fade;
    const Fade at = fade_at(t);
    weight = (whole * (at.twice_weight >> 6)) >> 31;                       // w < 2^31, 2φ < 2^32 in Q30
    const std::int64_t size = (whole * std::llabs(at.twice_slope)) >> 18;  // 2φ' within ±4
    const std::int64_t sign = at.twice_slope < 0 ? -1 : 1;
    slope = weight + sign * ((size * t) >> 20);
    out.weight_slope += sign * ((size << 9) / fade);
    const std::int64_t deep = (std::int64_t{fade} * ((at.twelve_height >> 24) / 12)) >> 20;   // H_0·ν, Q10: H_0 ≤ 2^30, ν ≤ 3 in Q30
    faded = whole * (deep >> 20) + (whole * (deep & 0xFFFFF) >> 20);
  }
  out.weight_sum += weight;
  out.faded_sum += faded >> 20;
  out.faded_rest += faded & 0xFFFFF;
  out.height_slope += slope;
}

namespace {

/// `paper`: the smallest height at which a ray crosses a tool triangle of the area's.
std::optional<std::uint32_t> height_in(const Frame& frame, const Area& area, const Int3& origin, const Int3& direction) {
  std::vector<std::uint32_t> triangles;
  const std::vector<Crossing> crossings = tool_crossings(frame, origin, direction, &triangles);
  const std::vector<std::uint32_t>& own = area.out.mobile_ids;   // ascending, as C_m is
  std::optional<std::uint32_t> least;
  for (std::size_t i = 0; i < crossings.size(); ++i)
    if (std::binary_search(own.begin(), own.end(), triangles[i]) && (!least || crossings[i].height < *least)) least = crossings[i].height;
  return least;
}

}  // namespace

void measure_heights(const Frame& frame, Area& area) {
  if (area.out.direction == Int3(0)) return;
  const Int3 down = -area.out.direction;
  const LatticeMesh& mesh = frame.mockup();
  if (frame.scene.refined()) {
    for (const Sample& sample : area.counting) {
      const auto found = height(frame, sample.point, down);
      if (!found) continue;
      area.rays.push_back({sample.point, found->height});
      add_height(area, found->height, mesh.sample_weight_q30[sample.triangle], sample.point, fade_height(frame, sample, down, found->normal));
    }
    return;
  }
  for (const std::uint32_t s : area.out.static_ids) {   // `paper`: the triangles' centroids, and the area's own C_m
    const Long3 sum = Long3(mesh.corner(s, 0)) + Long3(mesh.corner(s, 1)) + Long3(mesh.corner(s, 2));
    Int3 centroid;
    for (int k = 0; k < 3; ++k) centroid[k] = static_cast<std::int32_t>(floor_divide(sum[k], std::int64_t{3}));
    if (const auto hit = height_in(frame, area, centroid, down)) add_height(area, *hit, std::uint32_t{1} << 30, centroid, 0);
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

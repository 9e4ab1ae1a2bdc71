#include "cpu_ref/clearance.h"

#include <algorithm>
#include <tuple>

#include "cpu_ref/distance_of_triangles.h"

namespace palpate::cpu_ref {
namespace {

/// Squared gap of two boxes, steps². Coordinates within 2^30.
std::int64_t gap(const Box& a, const Box& b) {
  std::int64_t sum = 0;
  for (int k = 0; k < 3; ++k) {
    const std::int64_t away =
        std::max({std::int64_t{b.min[k]} - a.max[k], std::int64_t{a.min[k]} - b.max[k], std::int64_t{0}});
    sum += away * away;
  }
  return sum;
}

Box grown(const Box& box, std::int64_t by) {
  constexpr std::int64_t kEnd = 1 << 29;  // what a tree may be asked about
  Box out;
  for (int k = 0; k < 3; ++k) {
    out.min[k] = static_cast<std::int32_t>(std::max(box.min[k] - by, -kEnd));
    out.max[k] = static_cast<std::int32_t>(std::min(box.max[k] + by, kEnd));
  }
  return out;
}

}  // namespace

Clearance smallest_distance(const Frame& frame, std::int32_t within, bool collinear) {
  const auto counts = [&](std::uint32_t m) {
    return !frame.tool[m].collapsed() || (collinear && !frame.scene.geometry->tool.collapsed(m));
  };
  Clearance best;
  std::int64_t reach = within;  // no pair further than that is wanted
  std::vector<std::uint32_t> near;
  std::vector<std::pair<std::int64_t, std::uint32_t>> by_gap;
  const auto take_from = [&](std::uint32_t m, const Box& region) {
    const Triangle& mobile = frame.tool[m];
    const Box own = mobile.box();
    near.clear();
    by_gap.clear();
    frame.scene.mockup_tree.meeting(region, near);
    for (const std::uint32_t s : near)
      if (!frame.mockup().collapsed(s))
        by_gap.emplace_back(gap(triangle_of(frame.mockup(), s).box(), own), s);
    std::sort(by_gap.begin(), by_gap.end());
    for (const auto& [squared, s] : by_gap) {
      if (squared >= (reach + 1) * (reach + 1)) return;  // at least a step further
      const TriangleDistance found = distance_of(triangle_of(frame.mockup(), s), mobile);
      if (found.steps > reach) continue;
      if (best.kind == Clearance::Kind::kApart &&
          std::tuple(found.steps, s, m) >= std::tuple(best.steps, best.static_id, best.mobile_id))
        continue;
      best = {Clearance::Kind::kApart, found.steps, s, m, found.on_s, found.on_m};
      reach = found.steps;
    }
  };
  // A first pair that is about as near as any: of what lies in a box round the tool, doubled until something
  // does.
  for (std::int64_t by = 1024; best.kind == Clearance::Kind::kFurther; by *= 2) {
    near.clear();
    frame.scene.mockup_tree.meeting(grown(frame.tool_box, by), near);
    if (!near.empty()) {
      std::pair<std::int64_t, std::uint32_t> first{INT64_MAX, 0};
      const Box box = triangle_of(frame.mockup(), near.front()).box();
      for (std::uint32_t m = 0; m < frame.tool.size(); ++m)
        if (counts(m)) first = std::min(first, std::pair{gap(box, frame.tool[m].box()), m});
      if (first.first != INT64_MAX) take_from(first.second, grown(frame.tool_box, by));
    }
    if (by > within || by > 1 << 30) break;
  }
  for (std::uint32_t m = 0; m < frame.tool.size(); ++m)
    if (counts(m)) take_from(m, grown(frame.tool[m].box(), reach + 1));
  return best;
}

}  // namespace palpate::cpu_ref

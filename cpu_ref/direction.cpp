#include "cpu_ref/direction.h"

#include <algorithm>
#include <array>
#include <cstdlib>

#include "cpu_ref/samples.h"

namespace palpate::cpu_ref {
namespace {

/// A direction summed up. Terms within 2^31, fewer than 2^32 of them.
struct NormalSum {
  Long3 sum{0};
  std::int64_t weight = 0;
  bool is_usable() const { return usable(sum, weight); }
};

std::int64_t largest(const Long3& v) { return std::max({std::llabs(v.x), std::llabs(v.y), std::llabs(v.z)}); }

/// (w · n̂) >> 30 per component.
Long3 weighted(std::uint32_t weight_q30, const Int3& unit_normal_q30) {
  Long3 result;
  for (int k = 0; k < 3; ++k) result[k] = (std::int64_t{weight_q30} * unit_normal_q30[k]) >> 30;
  return result;
}

/// The held area that shares most static triangles with this one, at least one.
const HeldArea* held_of(const Frame& frame, const Area& area) {
  if (frame.held == nullptr) return nullptr;
  const HeldArea* best = nullptr;
  std::size_t most = 0;
  for (const HeldArea& held : frame.held->areas) {
    const auto common = std::count_if(held.static_ids.begin(), held.static_ids.end(), [&](std::uint32_t s) {
      return std::binary_search(area.out.static_ids.begin(), area.out.static_ids.end(), s);
    });
    if (static_cast<std::size_t>(common) > most) {
      most = static_cast<std::size_t>(common);
      best = &held;
    }
  }
  return best;
}

/// The side of the area's sheets: held, or towards gc. Sets sheet_sign and flags.
void choose_sheet_side(const Frame& frame, const HeldArea* held, Area& area) {
  Long3 sheets(0);
  bool any = false;
  for (const std::uint32_t s : area.out.static_ids)
    if (is_sheet(frame.mockup(), s)) {
      any = true;
      sheets += Long3(frame.mockup().unit_normal_q30[s]);
    }
  if (!any) return;
  area.out.flags |= kFlagSheet;
  if (held != nullptr && held->sheet_sign != 0) {
    area.out.sheet_sign = held->sheet_sign;
    area.out.flags |= kFlagHeld;
    return;
  }
  const Int3 gc = transform(frame.pose, frame.scene.geometry->tool_gc);
  area.out.sheet_sign = dot(sheets, Long3(gc) * std::int64_t{2} - Long3(area.doubled_centre())) >= 0 ? 1 : -1;
}

/// +1, or the area's sheet sign for a triangle of a sheet.
std::int64_t side_of(const Frame& frame, const Area& area, std::uint32_t s) {
  return is_sheet(frame.mockup(), s) ? area.out.sheet_sign : 1;
}

NormalSum static_normals(const Frame& frame, const Area& area) {
  NormalSum result;
  for (const Sample& sample : area.counting) {
    const std::uint32_t weight = frame.mockup().sample_weight_q30[sample.triangle];
    const std::int64_t side = side_of(frame, area, sample.triangle);
    result.sum += side * weighted(weight, frame.mockup().unit_normal_q30[sample.triangle]);
    result.weight += weight;
  }
  return result;
}

NormalSum mobile_normals(const Frame& frame, const Area& area) {
  NormalSum result;
  const LatticeMesh& mesh = frame.tool_mesh();
  for (const std::uint32_t m : area.out.mobile_ids) {
    const std::uint32_t weight = mesh.sample_weight_q30[m];
    const Long3 term = weighted(weight, turned(frame.pose, mesh.unit_normal_q30[m]));
    for_each_sample(mesh, m, frame.scene.geometry->sample_spacing, Box{Int3(-kLatticeReach), Int3(kLatticeReach)}, [&](const Int3& point) {
      if (frame.scene.mockup.class_of(transform(frame.pose, point)) == VoxelClass::kExternal) return;
      result.sum -= term;
      result.weight += weight;
    });
  }
  return result;
}

/// Needles only: where samples count and cancel, the few triangles that the tool's skin crosses may face any way.
NormalSum bare_static_normals(const Frame& frame, const Area& area) {
  NormalSum result;
  if (!area.counting.empty()) return result;
  for (const std::uint32_t s : area.cst) {
    result.sum += side_of(frame, area, s) * Long3(frame.mockup().unit_normal_q30[s]);
    result.weight += std::int64_t{1} << 30;
  }
  return result;
}

void find_refined(const Frame& frame, Area& area) {
  const HeldArea* held = held_of(frame, area);
  choose_sheet_side(frame, held, area);
  if (area.proximity()) {
    area.out.flags = 0;
    return;
  }
  if (frame.scene.tool_open()) area.out.flags |= kFlagToolOpen;

  // One zone: the surface itself tells, by its samples or, for a needle between them, by its triangles. Several zones: the
  // tool tells (chapter 3.2).
  using Rule = NormalSum (*)(const Frame&, const Area&);
  constexpr std::array<Rule, 3> kSmoothRules{static_normals, bare_static_normals, mobile_normals};
  constexpr std::array<Rule, 3> kEdgeRules{mobile_normals, static_normals, bare_static_normals};
  for (const Rule rule : area.out.zones.size() == 1 ? kSmoothRules : kEdgeRules) {
    const NormalSum sum = rule(frame, area);
    if (sum.is_usable()) {
      area.out.direction = normalise(sum.sum);
      return;
    }
    if (sum.weight > 0 && rule != bare_static_normals) area.out.flags |= kFlagCancelled;
  }
  if (held != nullptr) {
    area.out.direction = held->direction;
    area.out.flags |= kFlagHeld;
    return;
  }
  const Int3 c2 = area.doubled_centre();
  const Long3 way_out = frame.scene.mockup.to_nearest_external(Int3(c2.x >> 1, c2.y >> 1, c2.z >> 1));
  if (way_out != Long3(0)) {
    area.out.direction = normalise(way_out);
    area.out.flags |= kFlagNearestExternal;
    return;
  }
  area.out.flags |= kFlagNoDirection;
}

/// Chapter 3.2, to the letter but for the sign of the mobile normals.
void find_paper(const Frame& frame, Area& area) {
  Long3 sum(0);
  if (area.out.zones.size() == 1) {
    for (const std::uint32_t s : area.out.static_ids) sum += Long3(frame.mockup().unit_normal_q30[s]);
  } else {
    for (const std::uint32_t m : area.out.mobile_ids) sum -= Long3(turned(frame.pose, frame.tool_mesh().unit_normal_q30[m]));
  }
  if (sum == Long3(0))
    area.out.flags |= kFlagCancelled | kFlagNoDirection;
  else
    area.out.direction = normalise(sum);
}

}  // namespace

bool is_sheet(const LatticeMesh& mesh, std::uint32_t id) { return (mesh.flags[id] & kTriangleSheet) != 0; }

bool usable(const Long3& sum, std::int64_t weight) { return sum != Long3(0) && 8 * largest(sum) >= weight; }

Int3 normalise(const Long3& sum) {
  const std::int64_t low = std::int64_t{1} << 28, high = std::int64_t{1} << 29;
  int left = 0;   // k of the definition
  std::int64_t size = largest(sum);
  for (; size < low; size <<= 1) ++left;
  for (; size >= high; size >>= 1) --left;
  Int3 result;
  for (int k = 0; k < 3; ++k) {
    const std::int64_t magnitude = std::llabs(sum[k]);
    const std::int64_t scaled = left >= 0 ? magnitude << left : magnitude >> -left;
    result[k] = static_cast<std::int32_t>(sum[k] < 0 ? -scaled : scaled);
  }
  return result;
}

Int3 turned(const LatticePose& pose, const Int3& unit_normal_q30) {
  Int3 result;
  for (int r = 0; r < 3; ++r) {
    const std::int64_t sum = std::int64_t{pose.rotation_q30[r][0]} * unit_normal_q30.x +
                             std::int64_t{pose.rotation_q30[r][1]} * unit_normal_q30.y +
                             std::int64_t{pose.rotation_q30[r][2]} * unit_normal_q30.z;   // within 3 · 2^60
    result[r] = static_cast<std::int32_t>((sum + (std::int64_t{1} << 29)) >> 30);
  }
  return result;
}

void find_direction(const Frame& frame, Area& area) {
  if (frame.scene.refined())
    find_refined(frame, area);
  else
    find_paper(frame, area);
}

}  // namespace palpate::cpu_ref

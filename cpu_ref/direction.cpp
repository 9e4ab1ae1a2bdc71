#include "cpu_ref/direction.h"

#include <algorithm>
#include <cstdlib>

namespace palpate::cpu_ref {
namespace {

std::int64_t largest(const Long3& v) { return std::max({std::llabs(v.x), std::llabs(v.y), std::llabs(v.z)}); }

}  // namespace

bool is_sheet(const LatticeMesh& mesh, std::uint32_t id) { return (mesh.flags[id] & kTriangleSheet) != 0; }

Int3 normalise(const Long3& sum) {
  const std::int64_t low = std::int64_t{1} << 28, high = std::int64_t{1} << 29;
  int left = 0;  // k of the definition
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
                             std::int64_t{pose.rotation_q30[r][2]} * unit_normal_q30.z;  // within 3 · 2^60
    result[r] = static_cast<std::int32_t>((sum + (std::int64_t{1} << 29)) >> 30);
  }
  return result;
}

/// Chapter 3.2, to the letter but for the sign of the mobile normals.
void find_direction(const Frame& frame, Area& area) {
  Long3 sum(0);
  if (area.out.zones.size() == 1) {
    for (const std::uint32_t s : area.out.static_ids) sum += Long3(frame.mockup().unit_normal_q30[s]);
  } else {
    for (const std::uint32_t m : area.out.mobile_ids)
      sum -= Long3(turned(frame.pose, frame.tool_mesh().unit_normal_q30[m]));
  }
  if (sum == Long3(0))
    area.out.flags |= kFlagCancelled | kFlagNoDirection;
  else
    area.out.direction = normalise(sum);
}

}  // namespace palpate::cpu_ref

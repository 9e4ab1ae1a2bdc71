#include "compute/near_pairs.h"

#include <algorithm>
#include <bit>
#include <cmath>

namespace palpate {
namespace {

constexpr std::int32_t kFewVoxels = 64;   // beyond, a look at the brick as a whole comes first (chosen)

std::int32_t raised(std::int64_t v) { return static_cast<std::int32_t>(std::clamp<std::int64_t>(v, 0, 0xFFFF)); }

}  // namespace

Result<NearPairs> NearPairs::make(VulkanDevice& device, const SceneGeometry& geometry, const PartitionBuffers& mockup) {
  NearPairs out;
  out.grid_ = mockup.grid;
  out.per_voxel_ = 1.0 / mockup.grid.size;
  if (auto r = out.bricks_.read(device, mockup.bricks, mockup.grid.mixed_bricks); !r) return r.error();
  if (auto r = out.list_begin_.read(device, mockup.list_begin, std::size_t{mockup.grid.boundary_voxels} + 1); !r) return r.error();
  if (auto r = out.list_triangles_.read(device, mockup.list_triangles, mockup.grid.list_entries); !r) return r.error();
  const gpu::ivec3& n = mockup.grid.bricks;
  const std::int64_t extent = std::int64_t{8} * mockup.grid.size * std::max({n.x, n.y, n.z});
  while (extent >> out.shift_ > 0xFFFF) ++out.shift_;
  out.box_step_ = std::ldexp(1.0, static_cast<int>(out.shift_));
  const LatticeMesh& mesh = geometry.mockup;
  out.boxes_.resize(mesh.triangles.size());
  out.seen_by_.resize(mesh.triangles.size());
  for (std::uint32_t id = 0; id < out.boxes_.size(); ++id) {
    const Int3 a = mesh.corner(id, 0), b = mesh.corner(id, 1), c = mesh.corner(id, 2);
    out.boxes_[id] = out.box_of(glm::min(glm::min(a, b), c), glm::max(glm::max(a, b), c));
  }
  return out;
}

/// Rounding down is monotone, and so is clamping to the grid, which holds the mock-up: boxes that meet still do.
NearPairs::Box NearPairs::box_of(const Int3& low, const Int3& high) const {
  Box out;
  for (int k = 0; k < 3; ++k) {
    out[static_cast<std::size_t>(k)] = static_cast<std::uint16_t>(raised((std::int64_t{low[k]} - grid_.origin[k]) >> shift_));
    out[static_cast<std::size_t>(k) + 3] = static_cast<std::uint16_t>(raised((std::int64_t{high[k]} - grid_.origin[k]) >> shift_));
  }
  return out;
}

bool NearPairs::begin(const LatticePose& pose, const LatticeMesh& tool, std::uint32_t id, std::uint32_t place, Triangle& out) {
  out.place = place;
  for (int k = 0; k < 3; ++k) out.corners[static_cast<std::size_t>(k)] = transform(pose, tool.corner(id, k));
  const auto& [a, b, c] = out.corners;
  // Differences within 2^29 + 1: each component is exact within 2^60.
  const std::int64_t u[3] = {b.x - a.x, b.y - a.y, b.z - a.z}, v[3] = {c.x - a.x, c.y - a.y, c.z - a.z};
  const std::int64_t n[3] = {u[1] * v[2] - u[2] * v[1], u[2] * v[0] - u[0] * v[2], u[0] * v[1] - u[1] * v[0]};
  if (n[0] == 0 && n[1] == 0 && n[2] == 0) return false;
  out.normal_size = 0;
  for (std::size_t k = 0; k < 3; ++k) {
    out.normal[k] = static_cast<double>(n[k]);
    out.normal_size += std::abs(out.normal[k]);
  }
  out.box = box_of(glm::min(glm::min(a, b), c) - gpu::kCloseSteps, glm::max(glm::max(a, b), c) + gpu::kCloseSteps);
  if (++looker_ == 0) {   // once in 2^32 triangles
    std::fill(seen_by_.begin(), seen_by_.end(), 0u);
    looker_ = 1;
  }
  return true;
}

/// Whether all of a box of voxels, grown by kCloseSteps, lies on one side of the triangle's plane. A step is taken for the rounding of
/// doubles: with distances below 2^30 the sum is off by less than 2^-20 of the normal's size.
bool NearPairs::off_plane(const Triangle& triangle, const Int3& low, std::int32_t side) const {
  const double half = 0.5 * side;
  const Int3& a = triangle.corners[0];
  const double distance = triangle.normal[0] * (low.x - a.x + half) + triangle.normal[1] * (low.y - a.y + half) + triangle.normal[2] * (low.z - a.z + half);
  return std::abs(distance) > triangle.normal_size * (half + gpu::kCloseSteps + 1);
}

/// Whether all of a static triangle's box lies on one side of the triangle's plane. A box is low to high + 1 of its steps; slack as above.
bool NearPairs::off_plane(const Triangle& triangle, const Box& box) const {
  const Int3& a = triangle.corners[0];
  double distance = 0, reach = triangle.normal_size * (gpu::kCloseSteps + 1);
  for (std::size_t k = 0; k < 3; ++k) {
    const int axis = static_cast<int>(k);
    distance += triangle.normal[k] * (0.5 * box_step_ * (box[k] + box[k + 3] + 1) + (grid_.origin[axis] - a[axis]));
    reach += std::abs(triangle.normal[k]) * (0.5 * box_step_ * (box[k + 3] - box[k] + 1));
  }
  return std::abs(distance) > reach;
}

bool NearPairs::take_list(const Triangle& triangle, std::uint32_t boundary, NearLists& lists) {
  const Box& t = triangle.box;
  for (std::uint32_t e = list_begin_[boundary], end = list_begin_[boundary + 1]; e < end; ++e) {
    const std::uint32_t id = list_triangles_[e];
    const Box& s = boxes_[id];
    if (s[0] > t[3] || s[1] > t[4] || s[2] > t[5] || t[0] > s[3] || t[1] > s[4] || t[2] > s[5]) continue;
    if (seen_by_[id] == looker_) continue;   // one pair lies in many voxels
    seen_by_[id] = looker_;
    if (off_plane(triangle, s)) continue;
    if (!lists.push(lists.pairs, gpu::kListPairCandidates, {id, triangle.place})) return false;
  }
  return true;
}

bool NearPairs::take(const Triangle& triangle, const Int3& brick, std::uint32_t slot, NearLists& lists) {
  const std::int32_t size = grid_.size;
  const Int3 origin = grid_.origin + 8 * size * brick;
  if (slot == gpu::kBrickInternal) {
    if (off_plane(triangle, origin, 8 * size)) return true;
    return lists.push(lists.touch, gpu::kListTouchCandidates, {triangle.place, gpu::kNoVoxel, brick.x * 8 | brick.y * 8 << 16, brick.z * 8 | gpu::kWholeBrick});
  }
  const auto& [a, b, c] = triangle.corners;
  Int3 first, last;
  const Int3 low = glm::min(glm::min(a, b), c) - (gpu::kCloseSteps + 1) - origin, high = glm::max(glm::max(a, b), c) + (gpu::kCloseSteps + 1) - origin;
  for (int k = 0; k < 3; ++k) {
    if (low[k] > 8 * size || high[k] < 0) return true;
    // A quotient that is rounded wrongly is within 2^-20 of a voxel's side of the right one: the step added above covers it.
    first[k] = std::max(static_cast<std::int32_t>(std::floor(low[k] * per_voxel_)), 0);
    last[k] = std::min(static_cast<std::int32_t>(std::floor(high[k] * per_voxel_)), 7);
    if (first[k] > last[k]) return true;
  }
  const Int3 n = last - first + 1;
  if (n.x * n.y * n.z > kFewVoxels && off_plane(triangle, origin, 8 * size)) return true;
  const std::uint32_t along_x = (2u << last.x) - (1u << first.x);
  const gpu::Brick& voxels = bricks_[slot];
  for (std::int32_t z = first.z; z <= last.z; ++z)
    for (std::int32_t y = first.y; y <= last.y; ++y) {
      const std::uint32_t word = static_cast<std::uint32_t>(y >> 2 | z << 1), shift = static_cast<std::uint32_t>(y & 3) * 8;
      const std::uint32_t boundary = voxels.boundary[word];
      for (std::uint32_t row = (boundary | voxels.internal_[word]) >> shift & along_x; row != 0; row &= row - 1) {
        const auto x = static_cast<std::int32_t>(std::countr_zero(row));
        const std::uint32_t bit = 1u << (static_cast<std::uint32_t>(x) + shift);
        if (off_plane(triangle, origin + Int3(x, y, z) * size, size)) continue;
        const bool listed = (boundary & bit) != 0;
        const std::uint32_t number = listed ? voxels.first[word] + static_cast<std::uint32_t>(std::popcount(boundary & (bit - 1))) : gpu::kNoVoxel;
        const Int3 voxel = 8 * brick + Int3(x, y, z);
        if (!lists.push(lists.touch, gpu::kListTouchCandidates, {triangle.place, number, voxel.x | voxel.y << 16, voxel.z})) return false;
        if (listed && !take_list(triangle, number, lists)) return false;
      }
    }
  return true;
}

}  // namespace palpate

#include "compute/near_rays.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "compute/processor.h"

namespace palpate {
namespace {

/// Steps beside a triangle within which a ray may cross it: the transformed triangle that the device tests is rounded (0.87 steps) and turned by
/// a rounded matrix (0.3 steps for tools of PreparedScene::rays_walk()).
constexpr double kBeside = 2;

}  // namespace

Result<NearRays> NearRays::make(VulkanDevice& device, const LatticeMesh& tool, const PreparedScene& scene, std::span<const std::uint32_t> order) {
  NearRays out;
  const PartitionBuffers& fine = scene.fine.brick_slot ? scene.fine : scene.tool.partition;
  if (auto r = out.fine_.read(device, fine); !r) return r.error();
  out.place_of_.resize(order.size());
  for (std::uint32_t place = 0; place < order.size(); ++place) out.place_of_[order[place]] = place;
  out.tool_ = &tool;
  out.per_voxel_ = 1.0 / fine.grid.size;
  out.shadows_.resize(order.size());
  out.cast_in_.resize(order.size());
  return out;
}

void NearRays::aim(const Turn& turn, const Int3& along) {
  aimed_ = along;
  if (++aim_ == 0) {   // once in 2^32 directions
    std::fill(cast_in_.begin(), cast_in_.end(), 0u);
    aim_ = 1;
  }
  for (std::size_t k = 0; k < 3; ++k) {
    along_[k] = turn.row[k][0] * along.x + turn.row[k][1] * along.y + turn.row[k][2] * along.z;
    each_[k] = along_[k] == 0 ? std::numeric_limits<double>::infinity() : fine_.grid().size / std::abs(along_[k]);
  }
  axis_ = 0;
  for (std::size_t k = 1; k < 3; ++k)
    if (std::abs(along_[k]) > std::abs(along_[axis_])) axis_ = k;
  for (std::size_t i = 0; i < 2; ++i) {
    shear_[i] = along_[(axis_ + 1 + i) % 3] / along_[axis_];
    beside_[i] = kBeside * (1 + std::abs(shear_[i])) + 0x1p-8;   // doubles round by less than 2^-20
  }
}

/// Where a point lies across the rays.
std::array<double, 2> NearRays::see(const double (&p)[3]) const {
  return {p[(axis_ + 1) % 3] - p[axis_] * shear_[0], p[(axis_ + 2) % 3] - p[axis_] * shear_[1]};
}

/// Grown by what a ray may pass beside the triangle.
const NearRays::RayShadow& NearRays::shadow_of(std::uint32_t id) {
  if (cast_in_[id] != aim_) {
    cast_in_[id] = aim_;
    const auto corner = [&](int k) {
      const Int3 p = tool_->corner(id, k);
      return see({static_cast<double>(p.x), static_cast<double>(p.y), static_cast<double>(p.z)});
    };
    const auto a = corner(0), b = corner(1), c = corner(2);
    for (std::size_t i = 0; i < 2; ++i) {
      shadows_[id].low[i] = std::min({a[i], b[i], c[i]}) - beside_[i];
      shadows_[id].high[i] = std::max({a[i], b[i], c[i]}) + beside_[i];
    }
  }
  return shadows_[id];
}

/// What a voxel lists, without what the ray can't meet and what it has already (from `first` on).
bool NearRays::take_list(const Walk& ray, std::uint32_t boundary, std::uint32_t first, HostList<std::uint32_t>& places) {
  for (const std::uint32_t id : fine_.list(boundary)) {
    if (!shadow_of(id).holds(ray.shadow)) continue;
    const std::uint32_t place = place_of_[id];
    const auto seen = places.room.subspan(first, places.count - first);
    if (std::find(seen.begin(), seen.end(), place) != seen.end()) continue;
    if (!places.push(place)) return false;
  }
  return true;
}

NearRays::Turn::Turn(const LatticePose& pose) : translation(pose.translation) {
  for (std::size_t r = 0; r < 3; ++r)
    for (std::size_t c = 0; c < 3; ++c) row[c][r] = pose.rotation_q30[r][c] * 0x1p-30;
}

NearRays::Walk NearRays::begin(const Turn& turn, const Int3& point) const {
  const Int3 d = point - turn.translation;
  Walk walk;
  double from[3];
  for (std::size_t k = 0; k < 3; ++k) {
    const int axis = static_cast<int>(k);
    from[k] = turn.row[k][0] * d.x + turn.row[k][1] * d.y + turn.row[k][2] * d.z;
    const double at = (from[k] - fine_.grid().origin[axis]) * per_voxel_;
    walk.voxel[axis] = static_cast<std::int32_t>(std::floor(at));
    const double face = along_[k] > 0 ? walk.voxel[axis] + 1 - at : at - walk.voxel[axis];
    walk.next[k] = along_[k] == 0 ? std::numeric_limits<double>::infinity() : face * each_[k];
  }
  walk.shadow = see(from);
  return walk;
}

/// Into the next voxel.
void NearRays::step(Walk& walk) const {
  const std::size_t k = walk.next[0] < walk.next[1] ? (walk.next[0] < walk.next[2] ? 0 : 2) : (walk.next[1] < walk.next[2] ? 1 : 2);
  walk.t = walk.next[k];
  walk.next[k] += each_[k];
  walk.voxel[static_cast<int>(k)] += along_[k] > 0 ? 1 : -1;
}

/// Voxel by voxel, until one is V_ext: there the winding is 0, and what was crossed before adds up to the winding at the sample. No triangle is
/// within a step of a V_ext voxel, so that a crossing is clearly before or behind the voxel's face: RayList::stop.
bool NearRays::go_on(Walk& walk, std::uint32_t first, HostList<std::uint32_t>& places) {
  return on_this_processor([&] {
    const Int3 cells = 8 * fine_.grid().bricks;
    for (;; step(walk)) {
      for (int k = 0; k < 3; ++k) walk.outside = walk.outside || walk.voxel[k] < 0 || walk.voxel[k] >= cells[k];
      if (walk.outside) return true;
      const HostPartition::Voxel voxel = fine_.at(walk.voxel);
      if (voxel.kind == gpu::kVoxelExternal) return true;
      if (voxel.boundary != gpu::kNoVoxel && !take_list(walk, voxel.boundary, first, places)) return false;
    }
  });
}

bool NearRays::skip_external(Walk& walk) const {
  const Int3 cells = 8 * fine_.grid().bricks;
  for (;; step(walk)) {
    for (int k = 0; k < 3; ++k) walk.outside = walk.outside || walk.voxel[k] < 0 || walk.voxel[k] >= cells[k];
    if (walk.outside) return false;
    if (fine_.at(walk.voxel).kind != gpu::kVoxelExternal) return true;
  }
}

std::uint32_t NearRays::stop_of(const Walk& walk) { return static_cast<std::uint32_t>(std::min(std::ceil(walk.t * 0x1p30), 4294967295.0)); }

bool NearRays::find(const LatticePose& pose, std::span<const gpu::FrameSample> samples, std::span<const Int3> directions, std::span<gpu::RayList> rays,
                    HostList<std::uint32_t>& places) {
  const Turn turn(pose);
  bool aimed = false;
  for (std::size_t i = 0; i < samples.size(); ++i) {
    rays[i] = {places.count, places.count, 0};
    if (directions[i] == Int3(0)) continue;
    if (!aimed || aimed_ != -directions[i]) aim(turn, -directions[i]);
    aimed = true;
    Walk walk = begin(turn, samples[i].point);
    if (!go_on(walk, rays[i].begin, places)) return false;
    rays[i].end = places.count;
    rays[i].stop = stop_of(walk);
  }
  return true;
}

}  // namespace palpate

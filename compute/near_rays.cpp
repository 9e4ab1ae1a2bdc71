#include "compute/near_rays.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace palpate {
namespace {

/// Steps beside a triangle within which a ray may cross it: the transformed triangle that the device tests is rounded (0.87 steps) and turned by
/// a rounded matrix (0.3 steps for tools of PreparedScene::rays_walk()); a double's own rounding is far below.
constexpr double kBeside = 2;

}  // namespace

Result<NearRays> NearRays::make(VulkanDevice& device, const LatticeMesh& tool, const PreparedScene& scene, std::span<const std::uint32_t> order) {
  NearRays out;
  const PartitionBuffers& fine = scene.fine.brick_slot ? scene.fine : scene.tool.partition;
  if (auto r = out.fine_.read(device, fine); !r) return r.error();
  out.place_of_.resize(order.size());
  for (std::uint32_t place = 0; place < order.size(); ++place) out.place_of_[order[place]] = place;
  out.corners_.resize(order.size());
  for (std::uint32_t id = 0; id < order.size(); ++id)
    for (int corner = 0; corner < 3; ++corner)
      for (int k = 0; k < 3; ++k) out.corners_[id][static_cast<std::size_t>(corner)][static_cast<std::size_t>(k)] = tool.corner(id, corner)[k];
  return out;
}

/// What a voxel lists, without what the ray can't meet and what it has already (from `first` on).
bool NearRays::take_list(const Walk& ray, std::uint32_t boundary, std::uint32_t first, HostList<std::uint32_t>& places) const {
  const double* d = ray.along;
  for (const std::uint32_t id : fine_.list(boundary)) {
    const std::uint32_t place = place_of_[id];
    // Seen along the ray and dropped on each of the coordinate planes, the triangle's box must hold the ray.
    double low[3], high[3];
    for (std::size_t c = 0; c < 3; ++c) {
      const auto& corner = corners_[id][c];
      const double u[3] = {corner[0] - ray.from[0], corner[1] - ray.from[1], corner[2] - ray.from[2]};
      const double beside[3] = {d[1] * u[2] - d[2] * u[1], d[2] * u[0] - d[0] * u[2], d[0] * u[1] - d[1] * u[0]};
      for (std::size_t k = 0; k < 3; ++k) {
        low[k] = c == 0 ? beside[k] : std::min(low[k], beside[k]);
        high[k] = c == 0 ? beside[k] : std::max(high[k], beside[k]);
      }
    }
    bool may = true;
    for (std::size_t k = 0; k < 3; ++k) {
      const double margin = kBeside * (std::abs(d[(k + 1) % 3]) + std::abs(d[(k + 2) % 3]));
      may = may && low[k] <= margin && high[k] >= -margin;
    }
    if (!may) continue;
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

NearRays::Walk NearRays::begin(const Turn& turn, const Int3& point, const Int3& along) const {
  const gpu::GridConstants& grid = fine_.grid();
  const Int3 d = point - turn.translation;
  Walk walk;
  for (std::size_t k = 0; k < 3; ++k) {
    const int axis = static_cast<int>(k);
    walk.from[k] = turn.row[k][0] * d.x + turn.row[k][1] * d.y + turn.row[k][2] * d.z;
    walk.along[k] = turn.row[k][0] * along.x + turn.row[k][1] * along.y + turn.row[k][2] * along.z;
    const double at = (walk.from[k] - grid.origin[axis]) / grid.size;
    walk.voxel[axis] = static_cast<std::int32_t>(std::floor(at));
    const double face = walk.along[k] > 0 ? walk.voxel[axis] + 1 - at : at - walk.voxel[axis];
    walk.each[k] = walk.along[k] == 0 ? std::numeric_limits<double>::infinity() : grid.size / std::abs(walk.along[k]);
    walk.next[k] = walk.along[k] == 0 ? std::numeric_limits<double>::infinity() : face * walk.each[k];
  }
  return walk;
}

/// Into the next voxel.
void NearRays::step(Walk& walk) const {
  const std::size_t k = walk.next[0] < walk.next[1] ? (walk.next[0] < walk.next[2] ? 0 : 2) : (walk.next[1] < walk.next[2] ? 1 : 2);
  walk.t = walk.next[k];
  walk.next[k] += walk.each[k];
  walk.voxel[static_cast<int>(k)] += walk.along[k] > 0 ? 1 : -1;
}

/// Voxel by voxel, until one is V_ext: there the winding is 0, and what was crossed before adds up to the winding at the sample. No triangle is
/// within a step of a V_ext voxel, so that a crossing is clearly before or behind the voxel's face: RayList::stop.
bool NearRays::go_on(Walk& walk, std::uint32_t first, HostList<std::uint32_t>& places) const {
  const Int3 cells = 8 * fine_.grid().bricks;
  for (;; step(walk)) {
    for (int k = 0; k < 3; ++k) walk.outside = walk.outside || walk.voxel[k] < 0 || walk.voxel[k] >= cells[k];
    if (walk.outside) return true;
    const HostPartition::Voxel voxel = fine_.at(walk.voxel);
    if (voxel.kind == gpu::kVoxelExternal) return true;
    if (voxel.boundary != gpu::kNoVoxel && !take_list(walk, voxel.boundary, first, places)) return false;
  }
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
                    HostList<std::uint32_t>& places) const {
  const Turn turn(pose);
  for (std::size_t i = 0; i < samples.size(); ++i) {
    rays[i] = {places.count, places.count, 0};
    if (directions[i] == Int3(0)) continue;
    Walk walk = begin(turn, samples[i].point, -directions[i]);
    if (!go_on(walk, rays[i].begin, places)) return false;
    rays[i].end = places.count;
    rays[i].stop = stop_of(walk);
  }
  return true;
}

}  // namespace palpate

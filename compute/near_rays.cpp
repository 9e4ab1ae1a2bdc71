#include "compute/near_rays.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <limits>

namespace palpate {
namespace {

/// Steps beside a triangle within which a ray may cross it: the transformed triangle that the device tests is rounded (0.87 steps) and turned by
/// a rounded matrix (0.3 steps for tools of PreparedScene::rays_walk()); a double's own rounding is far below.
constexpr double kBeside = 2;

}  // namespace

/// A ray in the tool's lattice frame, off by less than 2^-18 of a step.
struct NearRays::Ray {
  double from[3], along[3];   ///< at parameter t: from + t · along; t = H / 2^30
};

Result<NearRays> NearRays::make(VulkanDevice& device, const LatticeMesh& tool, const PreparedScene& scene, std::span<const std::uint32_t> order) {
  NearRays out;
  const PartitionBuffers& fine = scene.fine.brick_slot ? scene.fine : scene.tool.partition;
  out.grid_ = fine.grid;
  const Int3 n = fine.grid.bricks;
  if (auto r = out.slots_.read(device, fine.brick_slot, static_cast<std::size_t>(n.x) * static_cast<std::size_t>(n.y) * static_cast<std::size_t>(n.z)); !r)
    return r.error();
  if (auto r = out.bricks_.read(device, fine.bricks, fine.grid.mixed_bricks); !r) return r.error();
  if (auto r = out.list_begin_.read(device, fine.list_begin, std::size_t{fine.grid.boundary_voxels} + 1); !r) return r.error();
  if (auto r = out.list_triangles_.read(device, fine.list_triangles, fine.grid.list_entries); !r) return r.error();
  out.place_of_.resize(order.size());
  for (std::uint32_t place = 0; place < order.size(); ++place) out.place_of_[order[place]] = place;
  out.corners_.resize(order.size());
  for (std::uint32_t id = 0; id < order.size(); ++id)
    for (int corner = 0; corner < 3; ++corner)
      for (int k = 0; k < 3; ++k) out.corners_[id][static_cast<std::size_t>(corner)][static_cast<std::size_t>(k)] = tool.corner(id, corner)[k];
  return out;
}

/// What a voxel lists, without what the ray can't meet and what it has already (from `first` on).
bool NearRays::take_list(const Ray& ray, std::uint32_t slot, unsigned bit, std::uint32_t first, HostList<std::uint32_t>& places) const {
  const gpu::Brick& brick = bricks_[slot];
  const std::uint32_t number = brick.first[bit >> 5] + static_cast<std::uint32_t>(std::popcount(brick.boundary[bit >> 5] & ((1u << (bit & 31)) - 1)));
  const double* d = ray.along;
  for (std::uint32_t e = list_begin_[number], end = list_begin_[number + 1]; e < end; ++e) {
    const std::uint32_t id = list_triangles_[e], place = place_of_[id];
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

/// Voxel by voxel, until one is V_ext: there the winding is 0, and what was crossed before adds up to the winding at the sample. No triangle is
/// within a step of a V_ext voxel, so that a crossing is clearly before or behind the voxel's face: RayList::stop.
bool NearRays::walk(const Ray& ray, gpu::RayList& out, HostList<std::uint32_t>& places) const {
  Int3 voxel, last = 8 * grid_.bricks - 1;
  double next[3], each[3], t = 0;   // parameter at the next face along each axis, from face to face, at the present voxel's entry
  for (std::size_t k = 0; k < 3; ++k) {
    const int axis = static_cast<int>(k);
    const double at = (ray.from[k] - grid_.origin[axis]) / grid_.size;
    voxel[axis] = static_cast<std::int32_t>(std::floor(at));
    const double face = ray.along[k] > 0 ? voxel[axis] + 1 - at : at - voxel[axis];
    each[k] = ray.along[k] == 0 ? std::numeric_limits<double>::infinity() : grid_.size / std::abs(ray.along[k]);
    next[k] = ray.along[k] == 0 ? std::numeric_limits<double>::infinity() : face * each[k];
  }
  out.begin = places.count;
  while (true) {
    bool outside = false;
    for (int k = 0; k < 3; ++k) outside = outside || voxel[k] < 0 || voxel[k] > last[k];
    if (outside) break;
    const std::uint32_t slot = slots_[static_cast<std::size_t>(voxel.x >> 3) + static_cast<std::size_t>(grid_.bricks.x) *
                                      (static_cast<std::size_t>(voxel.y >> 3) + static_cast<std::size_t>(grid_.bricks.y) * static_cast<std::size_t>(voxel.z >> 3))];
    if (slot == gpu::kBrickExternal) break;
    if (slot != gpu::kBrickInternal) {
      const auto bit = static_cast<unsigned>((voxel.x & 7) | (voxel.y & 7) << 3 | (voxel.z & 7) << 6);
      if ((bricks_[slot].boundary[bit >> 5] >> (bit & 31) & 1) != 0) {
        if (!take_list(ray, slot, bit, out.begin, places)) return false;
      } else if ((bricks_[slot].internal_[bit >> 5] >> (bit & 31) & 1) == 0) {
        break;
      }
    }
    const std::size_t k = next[0] < next[1] ? (next[0] < next[2] ? 0 : 2) : (next[1] < next[2] ? 1 : 2);
    t = next[k];
    next[k] += each[k];
    voxel[static_cast<int>(k)] += ray.along[k] > 0 ? 1 : -1;
  }
  out.end = places.count;
  out.stop = static_cast<std::uint32_t>(std::min(std::ceil(t * 0x1p30), 4294967295.0));
  return true;
}

bool NearRays::find(const LatticePose& pose, std::span<const gpu::FrameSample> samples, std::span<const Int3> directions, std::span<gpu::RayList> rays,
                    HostList<std::uint32_t>& places) const {
  double turn[3][3];   // tool from world
  for (std::size_t r = 0; r < 3; ++r)
    for (std::size_t c = 0; c < 3; ++c) turn[c][r] = pose.rotation_q30[r][c] * 0x1p-30;
  for (std::size_t i = 0; i < samples.size(); ++i) {
    rays[i] = {places.count, places.count, 0};
    if (directions[i] == Int3(0)) continue;
    const Int3 d = samples[i].point - pose.translation;
    Ray ray{};
    for (std::size_t k = 0; k < 3; ++k) {
      ray.from[k] = turn[k][0] * d.x + turn[k][1] * d.y + turn[k][2] * d.z;
      ray.along[k] = -(turn[k][0] * directions[i].x + turn[k][1] * directions[i].y + turn[k][2] * directions[i].z);
    }
    if (!walk(ray, rays[i], places)) return false;
  }
  return true;
}

}  // namespace palpate

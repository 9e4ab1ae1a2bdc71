#include "compute/nearest_external.h"

#include <algorithm>
#include <bit>

namespace palpate {
namespace {

struct Search {
  const gpu::GridConstants& grid;
  const HostCopy<std::uint32_t>& slots;
  const HostCopy<gpu::Brick>& bricks;
  Int3 point;
  std::int64_t distance = INT64_MAX;   // of the best voxel, squared, of twice the vectors; components of those lie within 2^30
  std::int64_t number = INT64_MAX;     // … and its number
  Int3 voxel{0};                       // … and itself

  std::int64_t distance_along(int k, std::int32_t v) const {
    const std::int64_t d = std::int64_t{2} * grid.origin[k] + (std::int64_t{2} * v + 1) * grid.size - std::int64_t{2} * point[k];
    return d * d;
  }
  std::int64_t distance_to(const Int3& v) const { return distance_along(0, v.x) + distance_along(1, v.y) + distance_along(2, v.z); }

  /// Of the voxels v of a row, the one whose centre is nearest; where two are, the lower.
  std::int32_t nearest_along(int k) const {
    const std::int64_t d = std::int64_t{point[k]} - grid.origin[k] - 1;
    return static_cast<std::int32_t>(d >= 0 ? d / grid.size : -((grid.size - 1 - d) / grid.size));
  }
  void offer(const Int3& v, std::int64_t at) {
    const Int3 n = 8 * grid.bricks;
    const std::int64_t its = v.x + n.x * (v.y + std::int64_t{n.y} * v.z);
    if (at > distance || (at == distance && its >= number)) return;
    distance = at;
    number = its;
    voxel = v;
  }
  void look_into(const Int3& brick) {
    const Int3& n = grid.bricks;
    const std::uint32_t slot = slots[static_cast<std::size_t>(brick.x) +
                                     static_cast<std::size_t>(n.x) * (static_cast<std::size_t>(brick.y) + static_cast<std::size_t>(n.y) * static_cast<std::size_t>(brick.z))];
    if (slot == gpu::kBrickInternal) return;
    Int3 nearest;
    for (int k = 0; k < 3; ++k) nearest[k] = std::clamp(nearest_along(k), 8 * brick[k], 8 * brick[k] + 7);
    const std::int64_t bound = distance_to(nearest);
    if (bound > distance) return;
    if (slot == gpu::kBrickExternal) return offer(nearest, bound);
    const gpu::Brick& in = bricks[slot];
    for (std::int32_t word = 0; word < 16; ++word)
      for (std::uint32_t left = ~(in.boundary[word] | in.internal_[word]); left != 0; left &= left - 1) {
        const std::int32_t bit = 32 * word + std::countr_zero(left);
        const Int3 v = 8 * brick + Int3(bit & 7, bit >> 3 & 7, bit >> 6);
        offer(v, distance_to(v));
      }
  }
};

}  // namespace

Int3 way_to_nearest_external(const gpu::GridConstants& grid, const HostCopy<std::uint32_t>& slots, const HostCopy<gpu::Brick>& bricks, const Int3& point) {
  Search search{.grid = grid, .slots = slots, .bricks = bricks, .point = point};
  const Int3 last = grid.bricks - 1;
  Int3 home;   // the brick that holds the point, or the nearest one
  for (int k = 0; k < 3; ++k) home[k] = std::clamp(search.nearest_along(k) >> 3, 0, last[k]);
  for (std::int32_t reach = 0;; ++reach) {
    // The six sides of a cube of bricks: on one of them a brick is `reach` away along that axis. Sides beyond the grid, or further than the
    // best, hold nothing.
    bool any = false;
    for (int k = 0; k < 3; ++k)
      for (const std::int32_t side : {-reach, reach}) {
        const std::int32_t at = home[k] + side;
        if (at < 0 || at > last[k] || (reach == 0 && (k != 0 || any))) continue;
        if (search.distance_along(k, std::clamp(search.nearest_along(k), 8 * at, 8 * at + 7)) > search.distance) continue;
        any = true;
        const int u = (k + 1) % 3, v = (k + 2) % 3;
        // Edges and corners of the cube belong to the first axis along which they are `reach` away.
        const std::int32_t u_in = reach - (u < k ? 1 : 0), v_in = reach - (v < k ? 1 : 0);
        for (std::int32_t i = std::max(home[u] - u_in, 0); i <= std::min(home[u] + u_in, last[u]); ++i)
          for (std::int32_t j = std::max(home[v] - v_in, 0); j <= std::min(home[v] + v_in, last[v]); ++j) {
            Int3 brick;
            brick[k] = at;
            brick[u] = i;
            brick[v] = j;
            search.look_into(brick);
          }
      }
    if (!any) break;
  }
  if (search.number == INT64_MAX) return Int3(0);
  return grid.origin + search.voxel * grid.size + grid.size / 2 - point;
}

}  // namespace palpate

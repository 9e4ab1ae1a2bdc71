// A partition as data, in the order of linear voxel numbers.
#include "compute/scene/partition.h"

#include <algorithm>
#include <numeric>
#include <vector>

namespace palpate {

VoxelPartition dense(const Partition& p) {
  VoxelPartition out;
  out.grid.origin = p.grid.origin;
  out.grid.size = p.grid.size;
  out.grid.bricks = p.grid.bricks;
  const std::uint64_t nx = static_cast<std::uint64_t>(p.grid.bricks.x),
                      ny = static_cast<std::uint64_t>(p.grid.bricks.y),
                      nz = static_cast<std::uint64_t>(p.grid.bricks.z);
  const std::uint64_t bricks = nx * ny * nz;

  const auto linear = [&](std::uint64_t brick, std::uint64_t bit) {
    const std::uint64_t x = brick % nx * 8 + (bit & 7), y = brick / nx % ny * 8 + (bit >> 3 & 7),
                        z = brick / (nx * ny) * 8 + (bit >> 6);
    return x + nx * 8 * (y + ny * 8 * z);
  };
  out.classes.assign(bricks * 512, VoxelClass::kExternal);
  for (std::uint64_t brick = 0; brick < bricks; ++brick) {
    const std::uint32_t slot = p.brick_slot[brick];
    if (slot == gpu::kBrickExternal) continue;
    for (std::uint64_t bit = 0; bit < 512; ++bit) {
      VoxelClass c = VoxelClass::kInternal;
      if (slot != gpu::kBrickInternal) {
        const gpu::Brick& b = p.bricks[slot];
        const std::uint32_t mask = 1u << (bit & 31);
        c = (b.boundary[bit >> 5] & mask) != 0    ? VoxelClass::kBoundary
            : (b.internal_[bit >> 5] & mask) != 0 ? VoxelClass::kInternal
                                                  : VoxelClass::kExternal;
      }
      out.classes[linear(brick, bit)] = c;
    }
  }

  // Compact order goes brick by brick: sort by linear number.
  std::vector<std::uint64_t> number(p.boundary_place.size());
  for (std::size_t i = 0; i < number.size(); ++i)
    number[i] = linear(p.mixed_brick[p.boundary_place[i] >> 9], p.boundary_place[i] & 511);
  std::vector<std::uint32_t> order(number.size());
  std::iota(order.begin(), order.end(), 0u);
  std::sort(order.begin(), order.end(),
            [&](std::uint32_t a, std::uint32_t b) { return number[a] < number[b]; });
  out.list_begin.push_back(0);
  for (const std::uint32_t i : order) {
    out.boundary_voxels.push_back(number[i]);
    out.list_triangles.insert(out.list_triangles.end(), p.list_triangles.begin() + p.list_begin[i],
                              p.list_triangles.begin() + p.list_begin[i + 1]);
    out.list_begin.push_back(out.list_triangles.size());
  }
  return out;
}

}  // namespace palpate

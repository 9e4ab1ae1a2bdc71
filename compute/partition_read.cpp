// The device's partition as data, in the order of linear voxel numbers.
#include <algorithm>
#include <numeric>
#include <vector>

#include "compute/prepared_scene.h"

namespace palpate {
namespace {

template <class T>
Result<std::vector<T>> read_all(VulkanDevice& device, const VulkanBuffer& buffer, std::uint64_t entries) {
  std::vector<T> out(entries);
  if (auto r = download(device, buffer, 0, out.data(), entries * sizeof(T)); !r) return r.error();
  return out;
}

}  // namespace

Result<VoxelPartition> read_partition(VulkanDevice& device, const PartitionBuffers& p) {
  VoxelPartition out;
  out.grid.origin = p.grid.origin;
  out.grid.size = p.grid.size;
  out.grid.bricks = p.grid.bricks;
  const std::uint64_t nx = static_cast<std::uint64_t>(p.grid.bricks.x), ny = static_cast<std::uint64_t>(p.grid.bricks.y),
                      nz = static_cast<std::uint64_t>(p.grid.bricks.z);
  const std::uint64_t bricks = nx * ny * nz;
  auto slots = read_all<std::uint32_t>(device, p.brick_slot, bricks);
  if (!slots) return slots.error();
  auto mixed = read_all<gpu::Brick>(device, p.bricks, p.grid.mixed_bricks);
  if (!mixed) return mixed.error();
  auto numbers = read_all<std::uint32_t>(device, p.mixed_brick, p.grid.mixed_bricks);
  if (!numbers) return numbers.error();
  auto places = read_all<std::uint32_t>(device, p.boundary_place, p.grid.boundary_voxels);
  if (!places) return places.error();
  auto begin = read_all<std::uint32_t>(device, p.list_begin, std::uint64_t{p.grid.boundary_voxels} + 1);
  if (!begin) return begin.error();
  auto lists = read_all<std::uint32_t>(device, p.list_triangles, p.grid.list_entries);
  if (!lists) return lists.error();

  const auto linear = [&](std::uint64_t brick, std::uint64_t bit) {
    const std::uint64_t x = brick % nx * 8 + (bit & 7), y = brick / nx % ny * 8 + (bit >> 3 & 7),
                        z = brick / (nx * ny) * 8 + (bit >> 6);
    return x + nx * 8 * (y + ny * 8 * z);
  };
  out.classes.assign(bricks * 512, VoxelClass::kExternal);
  for (std::uint64_t brick = 0; brick < bricks; ++brick) {
    const std::uint32_t slot = (*slots)[brick];
    if (slot == gpu::kBrickExternal) continue;
    for (std::uint64_t bit = 0; bit < 512; ++bit) {
      VoxelClass c = VoxelClass::kInternal;
      if (slot != gpu::kBrickInternal) {
        const gpu::Brick& b = (*mixed)[slot];
        const std::uint32_t mask = 1u << (bit & 31);
        c = (b.boundary[bit >> 5] & mask) != 0 ? VoxelClass::kBoundary
            : (b.internal_[bit >> 5] & mask) != 0 ? VoxelClass::kInternal : VoxelClass::kExternal;
      }
      out.classes[linear(brick, bit)] = c;
    }
  }

  // Compact order goes brick by brick: sort by linear number.
  std::vector<std::uint64_t> number(places->size());
  for (std::size_t i = 0; i < number.size(); ++i) number[i] = linear((*numbers)[(*places)[i] >> 9], (*places)[i] & 511);
  std::vector<std::uint32_t> order(number.size());
  std::iota(order.begin(), order.end(), 0u);
  std::sort(order.begin(), order.end(), [&](std::uint32_t a, std::uint32_t b) { return number[a] < number[b]; });
  out.list_begin.push_back(0);
  for (const std::uint32_t i : order) {
    out.boundary_voxels.push_back(number[i]);
    out.list_triangles.insert(out.list_triangles.end(), lists->begin() + (*begin)[i], lists->begin() + (*begin)[i + 1]);
    out.list_begin.push_back(out.list_triangles.size());
  }
  return out;
}

}  // namespace palpate

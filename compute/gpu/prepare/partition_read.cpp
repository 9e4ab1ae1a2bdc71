// The device's partition on the host.
#include <vector>

#include "compute/gpu/prepare/prepared_scene.h"

namespace palpate {
namespace {

template <class T>
Result<void> read(VulkanDevice& device, const VulkanBuffer& buffer, std::uint64_t entries,
                  std::vector<T>& out) {
  out.resize(entries);
  return download(device, buffer, 0, out.data(), entries * sizeof(T));
}

}  // namespace

Result<Partition> read_partition(VulkanDevice& device, const PartitionBuffers& p) {
  Partition out;
  out.grid = p.grid;
  out.has_internal = p.has_internal;
  if (auto r = read(device, p.brick_slot, brick_count(p.grid.bricks), out.brick_slot); !r) return r.error();
  if (auto r = read(device, p.bricks, p.grid.mixed_bricks, out.bricks); !r) return r.error();
  if (auto r = read(device, p.mixed_brick, p.grid.mixed_bricks, out.mixed_brick); !r) return r.error();
  if (auto r = read(device, p.boundary_place, p.grid.boundary_voxels, out.boundary_place); !r)
    return r.error();
  if (auto r = read(device, p.list_begin, std::uint64_t{p.grid.boundary_voxels} + 1, out.list_begin); !r)
    return r.error();
  if (auto r = read(device, p.list_triangles, p.grid.list_entries, out.list_triangles); !r) return r.error();
  return out;
}

}  // namespace palpate

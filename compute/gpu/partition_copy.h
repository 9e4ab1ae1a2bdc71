#pragma once
#include "compute/gpu/host_copy.h"
#include "compute/gpu/prepare/prepared_scene.h"
#include "compute/scene/scene_tables.h"

namespace palpate {

/// A partition of the device's for the host to read. The buffers outlive this and are not written meanwhile.
class PartitionCopy {
 public:
  /// Allocates where the buffers are not mapped.
  Result<void> read(VulkanDevice& device, const PartitionBuffers& from) {
    grid_ = from.grid;
    if (auto r = brick_slot_.read(device, from.brick_slot, brick_count(grid_.bricks)); !r) return r;
    if (auto r = mixed_brick_.read(device, from.mixed_brick, grid_.mixed_bricks); !r) return r;
    if (auto r = bricks_.read(device, from.bricks, grid_.mixed_bricks); !r) return r;
    if (auto r = boundary_place_.read(device, from.boundary_place, grid_.boundary_voxels); !r) return r;
    if (auto r = list_begin_.read(device, from.list_begin, std::size_t{grid_.boundary_voxels} + 1); !r)
      return r;
    return list_triangles_.read(device, from.list_triangles, grid_.list_entries);
  }
  PartitionView view() const {
    PartitionView out;
    out.grid = grid_;
    out.brick_slot = brick_slot_.all();
    out.mixed_brick = mixed_brick_.all();
    out.bricks = bricks_.all();
    out.boundary_place = boundary_place_.all();
    out.list_begin = list_begin_.all();
    out.list_triangles = list_triangles_.all();
    return out;
  }

 private:
  gpu::GridConstants grid_{};
  HostCopy<std::uint32_t> brick_slot_, mixed_brick_, boundary_place_, list_begin_, list_triangles_;
  HostCopy<gpu::Brick> bricks_;
};

}  // namespace palpate

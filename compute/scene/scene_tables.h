#pragma once
#include <cstdint>
#include <memory>
#include <span>

#include "compute/scene/partition.h"
#include "compute/scene/samples.h"
#include "shaders/shared/scene.h"

namespace palpate {

struct SearchTables;

inline constexpr std::int32_t kVoxelParts =
    256;  ///< of a voxel's side, in which boxes of triangles in it are kept: a byte says which

/// A partition that lies somewhere on the host: as Partition.
struct PartitionView {
  gpu::GridConstants grid{};
  bool has_internal = false;
  std::span<const std::uint32_t> brick_slot, mixed_brick, boundary_place, list_begin, list_triangles;
  std::span<const gpu::Brick> bricks;

  PartitionView() = default;
  PartitionView(const Partition& p)  // NOLINT: a partition is a view of itself
      : grid(p.grid),
        has_internal(p.has_internal),
        brick_slot(p.brick_slot),
        mixed_brick(p.mixed_brick),
        boundary_place(p.boundary_place),
        list_begin(p.list_begin),
        list_triangles(p.list_triangles),
        bricks(p.bricks) {}

  /// The voxel of a boundary voxel's number.
  Int3 boundary_voxel(std::uint32_t boundary) const {
    const std::uint32_t place = boundary_place[boundary], bit = place & 511;
    return 8 * brick_at(grid.bricks, mixed_brick[place >> 9]) + Int3(bit & 7, bit >> 3 & 7, bit >> 6);
  }
};

/// A prepared scene as frames on the host read it. What it names outlives it.
struct SceneTables {
  gpu::SceneConstants constants{};
  PartitionView mockup;
  PartitionView tool;  ///< empty in `paper`
  PartitionView fine;  ///< of a closed tool in finer voxels; where there is none, the tool's own
  std::span<const std::uint32_t> fine_exit;  ///< by boundary voxel of a closed tool's `fine`: kBindFineExit
  std::span<const std::uint32_t> tool_near;  ///< a bit a voxel of `fine`: a mock-up voxel with its centre
                                             ///< there may meet the tool's solid; may be empty: all may
  std::shared_ptr<const VoxelSamples> samples;  ///< may be null or empty: frames work them out
  std::shared_ptr<const SearchTables> search;   ///< never null
};

}  // namespace palpate

#pragma once
#include <cstdint>
#include <optional>

#include "model/lattice/lattice_mesh.h"
#include "model/mesh/mass.h"
#include "model/result.h"

namespace palpate {

inline constexpr std::int32_t kSmallestVoxel = 8;  ///< steps (EXACTNESS section 2)
inline constexpr double kMaxBoundaryVoxels = 8e6;  ///< estimated, of either body (chosen: memory)
inline constexpr double kMaxVoxelEntries =
    128e6;  ///< estimated entries of the voxels' triangle lists (chosen: memory)
inline constexpr double kMaxBricks =
    16.0 * 1024 * 1024 - 2;  ///< of either grid: 8 bytes a brick and two entries more fit 128 MiB, the
                             ///< storage buffer every Vulkan device offers
inline constexpr std::int32_t kMaxAutoBricksAlong =
    3500;  ///< of a grid along an axis, which every back end takes (shaders/shared/prepare.h:
           ///< kMostBricksAlong)
inline constexpr std::int32_t kSamplesPerVoxelSide =
    4;  ///< default sample spacing: a quarter of a voxel (METHOD section 4)
inline constexpr std::int32_t kMaxSamplesPerVoxelSide =
    63;  ///< a voxel is reached into by at most 64 of its cells

/// A body as the choice of the voxel size sees it.
struct VoxelSubject {
  SurfaceMeasure measure;  ///< steps
  Int3 box_min{0}, box_max{0};
};

/// Voxel size in steps, even. `asked_m` empty: the least of the cost function of docs/VOXEL_SIZE.md; it
/// depends on the two bodies alone. Error (kBadValue): a size asked for that is not finite, under 8 steps or
/// beyond a limit above.
Result<std::int32_t> choose_voxel_size(const VoxelSubject& mockup, const VoxelSubject& tool, double step_m,
                                       std::optional<double> asked_m);

/// Sample spacing in steps. `asked_m` empty: a quarter of the voxel, or of `auto_voxel`, the size that `auto`
/// chooses, where that is smaller (docs/VOXEL_SIZE.md). Error (kBadValue): a spacing asked for that is not
/// finite, under a step, under 1/63 of a voxel, or over 8 voxels.
Result<std::int32_t> choose_sample_spacing(std::int32_t voxel_size, std::int32_t auto_voxel, double step_m,
                                           std::optional<double> asked_m);

}  // namespace palpate

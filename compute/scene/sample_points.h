#pragma once
#include <cstdint>
#include <functional>
#include <vector>

#include "compute/scene/samples.h"
#include "compute/scene/scene_tables.h"
#include "model/lattice/lattice_mesh.h"

namespace palpate {

/// What became of a list that was to be made.
enum class Listing : std::uint8_t { kDone, kTooMany, kCancelled };

/// Whether to go on, asked now and then on the calling thread; `done` is a share from 0 to 1.
using ListingProgress = std::function<bool(double done)>;

/// For sharing the work on a partition's lists out: voxels [begins[i], begins[i + 1]) have some thousand
/// entries.
std::vector<std::uint32_t> entry_shares(const PartitionView& lists);

/// Voxel by voxel what an engine has listed entry by entry, on all cores. kTooMany: a voxel lists more than
/// VoxelSamples::kLongestList. What is not done leaves `out` half written.
Listing list_points(const LatticeMesh& mesh, const PartitionView& lists, std::int32_t spacing,
                    const ListingProgress& go_on, EntrySamples from, VoxelSamples& out);

}  // namespace palpate

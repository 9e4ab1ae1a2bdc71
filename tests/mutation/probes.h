#pragma once
#include <cstdint>
#include <string>
#include <utility>
#include <vector>

#include "model/scene/scene_geometry.h"

namespace palpate::mutation {

/// The reference's parts asked directly, of the points of tests/compute/geometry_cases.h, which lie where
/// points, edges and planes coincide: what each says, as a number that any other answer changes.
/// tests/cpu_ref and tests/compute hold the same parts against the definitions.
using Probe = std::pair<const char*, std::uint64_t (*)()>;
const std::vector<Probe>& probes();

/// The same of the host's exact code.
const std::vector<Probe>& host_probes();

/// The nearest V_ext voxel (EXACTNESS section 6) of points in and round a body's grid, as such a number.
std::uint64_t probe_ways_out(const LatticeMesh& mesh, const VoxelGrid& grid);

}  // namespace palpate::mutation

#pragma once
#include <cstdint>

#include "compute/host_copy.h"
#include "model/vector.h"
#include "shaders/shared/scene.h"

namespace palpate {

/// From a point to the centre of the nearest V_ext voxel of a grid, world lattice steps (docs/EXACTNESS.md section 6); of equally near ones to
/// that with the smallest number (x fastest). 0 where the point is that centre, or where no voxel is V_ext. `slots`: of all bricks of the
/// grid. Looks at bricks in larger and larger cubes round the point, until nothing in the next could be nearer.
Int3 way_to_nearest_external(const gpu::GridConstants& grid, const HostCopy<std::uint32_t>& slots, const HostCopy<gpu::Brick>& bricks, const Int3& point);

}  // namespace palpate

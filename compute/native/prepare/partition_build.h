#pragma once
#include <cstdint>
#include <functional>

#include "compute/scene/partition.h"
#include "model/lattice/lattice_mesh.h"
#include "model/lattice/voxel_grid.h"
#include "model/result.h"

namespace palpate::native {

/// Asked now and then on the calling thread; false: preparation ends.
using GoOn = std::function<bool()>;

/// The partition of a body, on all cores. `growth`: steps by which a voxel grows before it is asked what it
/// touches. `name` opens sentences ("mock-up"). Errors: kBadValue for a grid that is too large; cancelled.
Result<Partition> make_partition(const LatticeMesh& mesh, const VoxelGrid& grid, std::int32_t growth,
                                 const char* name, const GoOn& go_on);

/// Everything of a partition but the classes of what is not boundary: as if all of it were V_ext.
Result<Partition> list_voxels(const LatticeMesh& mesh, const VoxelGrid& grid, std::int32_t growth,
                              const char* name, const GoOn& go_on);

/// Classes of the voxels that are not boundary. False: cancelled.
bool classify(const LatticeMesh& mesh, const GoOn& go_on, Partition& partition);

/// The error of who was told to stop.
Error cancelled();

}  // namespace palpate::native

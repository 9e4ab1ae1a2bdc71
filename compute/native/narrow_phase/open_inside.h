#pragma once
#include <cstdint>
#include <memory>
#include <vector>

#include "compute/native/narrow_phase/inside_cells.h"
#include "compute/native/narrow_phase/middle_crossings.h"
#include "compute/scene/partition_lookup.h"
#include "model/lattice/lattice_mesh.h"

namespace palpate {

/// What is worked out once of a body that is not closed and is asked much which points lie in it. Any number
/// of threads.
struct OpenInside {
  InsideCells cells;
  MiddleCrossings crossings;
  /// A bit for each quarter of a voxel: the middle of a voxel of the other body there, as large as this
  /// one's, may have a point of that voxel inside. Empty: nothing is known.
  std::vector<std::uint32_t> near;
  static constexpr int kNearParts = 4;  ///< of a voxel along an axis (chosen: a sample's spacing)

  /// Allocates. `partition`: the body's own.
  static std::shared_ptr<const OpenInside> make(const LatticeMesh& mesh, const PartitionView& partition);
  std::uint64_t bytes() const { return cells.bytes() + crossings.bytes() + 4 * near.size(); }
};

}  // namespace palpate

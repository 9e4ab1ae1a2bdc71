#pragma once
#include <cstdint>
#include <memory>
#include <span>
#include <vector>

#include "compute/native/narrow_phase/inside_cells.h"
#include "compute/native/narrow_phase/middle_crossings.h"
#include "compute/native/narrow_phase/open_shells.h"
#include "compute/scene/partition_lookup.h"
#include "model/lattice/lattice_mesh.h"

namespace palpate {

/// What is worked out once of a body that is not closed, and more of one that is asked much which points lie
/// in it. Any number of threads.
struct OpenInside {
  std::shared_ptr<const OpenShells> shells;  ///< never null
  InsideCells cells;                         ///< of a body that is asked much, as what follows; else empty
  MiddleCrossings crossings;
  /// A bit for each quarter of a voxel: the middle of a voxel of the other body there, as large as this
  /// one's, may have a point of that voxel inside. Empty: nothing is known.
  std::vector<std::uint32_t> near;
  static constexpr int kNearParts = 4;  ///< of a voxel along an axis (chosen: a sample's spacing)

  /// `partition`: the body's own; `boxes`: SearchTables::boxes of it. Allocates. Null: `go_on` said stop.
  static std::shared_ptr<const OpenShells> count_shells(const LatticeMesh& mesh,
                                                        const PartitionView& partition,
                                                        std::span<const std::uint8_t> boxes,
                                                        const OpenShells::GoOn& go_on);
  /// For a body that is asked much. Allocates.
  static std::shared_ptr<const OpenInside> make(const LatticeMesh& mesh, const PartitionView& partition,
                                                std::span<const std::uint8_t> boxes,
                                                std::shared_ptr<const OpenShells> shells);
  std::uint64_t bytes() const {
    return shells->bytes() + cells.bytes() + crossings.bytes() + 4 * near.size();
  }
};

/// Of both bodies of a scene, each null where it is closed, or nothing can lie inside it.
struct OpenBodies {
  std::shared_ptr<const OpenInside> mockup, tool;
  std::uint64_t bytes() const { return (mockup ? mockup->bytes() : 0) + (tool ? tool->bytes() : 0); }
};

}  // namespace palpate

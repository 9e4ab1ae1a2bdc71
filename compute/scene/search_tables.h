#pragma once
#include <array>
#include <cstdint>
#include <functional>
#include <memory>
#include <vector>

#include "compute/scene/scene_tables.h"
#include "compute/scene/triangle_tree.h"
#include "model/scene/scene_geometry.h"

namespace palpate {

/// What the search looks at of the mock-up beside its partition. Made once a scene and kept in the cache;
/// every frame reads it.
struct SearchTables {
  /// Boxes of triangles, each as far as it lies in a voxel that lists it, in kVoxelParts-ths of the voxel:
  /// for the list of n from `begin` on, six times n bytes from 6 · begin on, all lows along x, then y and z,
  /// then highs. kBoxesAtOnce more at the end say nothing.
  std::vector<std::uint8_t> boxes;
  /// Parts of the mock-up, connected by corners, that would fit into the tool: low x, y, z, high x, y, z;
  /// steps.
  std::vector<std::array<std::int32_t, 6>> parts;

  TriangleTree triangles;  ///< of the mock-up

  std::uint64_t bytes() const {
    return boxes.size() + sizeof parts[0] * std::uint64_t{parts.size()} + triangles.bytes();
  }

  static constexpr std::size_t kBoxesAtOnce = 16;  ///< may be read from any place on

  /// `boxes` of another body's partition, the tool's.
  static std::vector<std::uint8_t> boxes_of(const LatticeMesh& mesh, const PartitionView& partition);

  /// On all cores; `go_on` is asked now and then on this thread. Cancelled: null.
  static std::shared_ptr<const SearchTables> make(const SceneGeometry& geometry, const PartitionView& mockup,
                                                  const std::function<bool()>& go_on);
};

}  // namespace palpate

#pragma once
#include <cstdint>
#include <memory>
#include <vector>

#include "compute/native/narrow_phase/open_inside.h"
#include "compute/scene/scene_tables.h"
#include "model/collision_backend.h"
#include "model/scene/plan.h"

namespace palpate::native {

/// All that frames read of a scene, in `refined`. Frames of any number of threads share it.
struct Scene {
  gpu::SceneConstants constants{};
  Partition mockup, tool;
  Partition fine;  ///< of a closed tool in finer voxels; may be empty: the tool's own serves
  std::vector<std::uint32_t> fine_exit, tool_near;  ///< as SceneTables has them
  std::shared_ptr<const VoxelSamples> samples;      ///< may be null: frames work them out
  std::shared_ptr<const SearchTables> search;       ///< never null

  std::shared_ptr<const OpenShells> mockup_shells, tool_shells;  ///< null: the body is closed, or nothing
                                                                 ///< can lie inside it
  OpenBodies open;                                               ///< what no cache keeps

  const Partition& finest() const { return fine.brick_slot.empty() ? tool : fine; }
  /// Valid as long as this neither moves nor changes.
  SceneTables tables() const;
  std::uint64_t bytes() const;
  /// Fills `open`. Last of all.
  void know(const SceneGeometry& geometry);
};

/// What listing the mock-up's samples takes at most, and keeping them, known before: of large faces they are
/// most of a scene.
std::uint64_t most_sample_bytes(const SceneGeometry& geometry);

/// Makes all of it, on all cores. Errors: a grid that is too large (kBadValue), cancelled.
Result<Scene> prepare_scene(const SceneGeometry& geometry, const Plan& plan, const Progress& progress);

}  // namespace palpate::native

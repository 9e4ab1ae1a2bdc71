#pragma once
#include "model/scene/plan.h"
#include "model/scene/scene_geometry.h"
#include "shaders/shared/scene.h"

namespace palpate {

/// What the making of partitions has found. Grids are all 0 where there is none.
struct PreparedGrids {
  gpu::GridConstants mockup{}, tool{};
  gpu::GridConstants fine{};  ///< the tool's finer one, or its own
  bool mockup_has_inside = false, tool_has_inside = false;
};

/// Numbers of a prepared scene.
gpu::SceneConstants scene_constants(const SceneGeometry& geometry, const Plan& plan,
                                    const PreparedGrids& prepared);

}  // namespace palpate

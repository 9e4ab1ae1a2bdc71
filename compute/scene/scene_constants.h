#pragma once
#include "model/scene/plan.h"
#include "model/scene/scene_geometry.h"
#include "shaders/shared/scene.h"

namespace palpate {

/// What the making of a partition has found. All 0 where there is none.
struct PreparedGrid {
  gpu::GridConstants grid{};
  bool has_internal = false;
};

/// Numbers of a prepared scene. `fine`: the tool's finer partition, or its own.
gpu::SceneConstants scene_constants(const SceneGeometry& geometry, const Plan& plan,
                                    const PreparedGrid& mockup, const PreparedGrid& tool,
                                    const gpu::GridConstants& fine);

}  // namespace palpate

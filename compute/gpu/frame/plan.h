#pragma once
#include <vector>

#include "compute/vulkan/pipeline.h"
#include "model/scene/plan.h"

namespace palpate {

/// The plan as a frame takes it once the scene is prepared: what preparation has found absent is left out, if
/// it may be.
Plan frame_plan(const Plan& plan, bool has_internal);

/// The constants of shaders/lib/plan.glsl that differ from what stands there, so that the whole plan's
/// pipelines need none.
std::vector<SpecConstant> plan_constants(const Plan& plan);

}  // namespace palpate

#pragma once
#include <cstdint>
#include <vector>

#include "compute/vulkan/device.h"
#include "compute/vulkan/pipeline.h"
#include "model/contact/contacts.h"
#include "model/lattice/lattice.h"
#include "model/result.h"
#include "model/scene/plan.h"
#include "shaders/shared/frame.h"
#include "shaders/shared/scene.h"

namespace palpate {

/// The plan as a frame takes it once the scene is prepared: what preparation has found absent is left out, if
/// it may be.
Plan frame_plan(const Plan& plan, bool has_internal);

/// The constants of shaders/lib/plan.glsl that differ from what stands there, so that the whole plan's
/// pipelines need none.
std::vector<SpecConstant> plan_constants(const Plan& plan);

/// How many invocations look for a sample's depth together (constant LANES), from 8 on: few on a processor,
/// and in a batch, whose samples keep a GPU busy.
std::uint32_t depth_lanes(const VulkanDevice& device, bool batch);

/// ContactFlag bits of every answer within the lattice.
std::uint32_t flags_of_frames(const gpu::SceneConstants& scene);

/// A pose as shaders read it; nothing is ignored, nothing coarser.
gpu::FrameInput frame_input(const LatticePose& pose);

/// What an emptied answer says whatever the pose finds.
void begin_answer(const Plan& plan, Contacts& out);

}  // namespace palpate

#pragma once
#include <cstdint>
#include <vector>

#include "compute/gpu/frame/capacity.h"
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

/// What a device does best with, on frames alone or in a batch.
WorkCut work_cut(const VulkanDevice& device, bool batch);

/// The cut as shaders are told it.
void add_constants(const WorkCut& cut, std::vector<SpecConstant>& to);

/// ContactFlag bits of every answer within the lattice.
std::uint32_t flags_of_frames(const gpu::SceneConstants& scene);

/// A pose as shaders read it; nothing is ignored, nothing coarser.
gpu::FrameInput frame_input(const LatticePose& pose);

/// What an emptied answer says whatever the pose finds.
void begin_answer(const Plan& plan, Contacts& out);

}  // namespace palpate

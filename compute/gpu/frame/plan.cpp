#include "compute/gpu/frame/plan.h"

#include <cstddef>

namespace palpate {
namespace {

// A GPU has far more invocations than a contact has samples, and each waits for its loads.
constexpr std::uint32_t kLanesOfGpu = 64, kLanes = 1;

}  // namespace

Plan frame_plan(const Plan& plan, bool has_internal) {
  Plan out = plan;
  if (plan.spare_absent && !has_internal) out.imt = false;
  return out;
}

std::vector<SpecConstant> plan_constants(const Plan& plan) {
  std::vector<SpecConstant> out;
  if (!plan.imt) out.push_back({17, 0});
  if (!plan.zones) out.push_back({18, 0});
  if (!plan.contact_point) out.push_back({19, 0});
  return out;
}

std::uint32_t depth_lanes(const VulkanDevice& device, bool batch) {
  return device.processor() || batch ? kLanes : kLanesOfGpu;
}

std::uint32_t flags_of_frames(const gpu::SceneConstants& scene) {
  return scene.refined != 0 && scene.tool.closed == 0 && scene.tool.has_internal == 0
             ? std::uint32_t{kFlagToolOpen}
             : 0u;
}

gpu::FrameInput frame_input(const LatticePose& pose) {
  gpu::FrameInput out{};
  for (std::size_t i = 0; i < 9; ++i) out.rotation_q30[i] = pose.rotation_q30[i / 3][i % 3];
  out.translation = pose.translation;
  return out;
}

void begin_answer(const Plan& plan, Contacts& out) {
  out.engine = "gpu";
  out.contact_points = plan.contact_point;
  out.lists = plan.telemetry;
}

}  // namespace palpate

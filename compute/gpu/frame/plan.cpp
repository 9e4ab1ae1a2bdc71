#include "compute/gpu/frame/plan.h"

#include <algorithm>
#include <cstddef>

namespace palpate {
namespace {

// A GPU has far more invocations than a contact has parts, and each waits for its loads: what one does after
// the other is what a frame takes. In a batch other poses keep it busy. llvmpipe pays for each workgroup,
// without work, too, and for barriers.
constexpr WorkCut kFine{.clusters = 8,
                        .brick_groups = 2048,
                        .bricks_at_once = 1,
                        .lanes = 64,
                        .runs_a_group = 1,
                        .pair_chunk = 4,
                        .listed_chunk = 4,
                        .field_tile = 16},
    kCoarse{.clusters = 64,
            .brick_groups = 2,
            .bricks_at_once = 64,
            .lanes = 1,
            .runs_a_group = 8,
            .pair_chunk = 16,
            .listed_chunk = 16,
            .field_tile = 64};
// Shaders keep a bit for each of a chunk.
static_assert(std::max({kFine.pair_chunk, kCoarse.pair_chunk, kFine.listed_chunk, kCoarse.listed_chunk}) <=
              32);

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

WorkCut work_cut(const VulkanDevice& device, bool batch) {
  return device.processor() || batch ? kCoarse : kFine;
}

void add_constants(const WorkCut& cut, std::vector<SpecConstant>& to) {
  to.insert(to.end(), {{gpu::kLanesConstant, cut.lanes},
                       {gpu::kRunsAGroupConstant, cut.runs_a_group},
                       {gpu::kPairChunkConstant, cut.pair_chunk},
                       {gpu::kListedChunkConstant, cut.listed_chunk},
                       {gpu::kFieldTileConstant, cut.field_tile}});
}

std::uint32_t flags_of_frames(const gpu::SceneConstants& scene) {
  return scene.refined != 0 && scene.tool_has_inside == 0 ? std::uint32_t{kFlagToolOpen} : 0u;
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

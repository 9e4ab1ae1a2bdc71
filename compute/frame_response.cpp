#include "compute/frame_response.h"

#include <array>
#include <bit>
#include <vector>

#include "compute/frame_plan.h"
#include "shaders/code.h"

namespace palpate {
namespace {

using namespace gpu;

/// One buffer of the response.
struct BufferPlan {
  std::int32_t binding;
  const char* what;
  std::uint64_t bytes;
  bool table = false;   // all 0 between frames
  BufferKind kind = BufferKind::kDevice;
};

}  // namespace

Result<void> FrameResponse::make_buffers(VulkanDevice& device, std::uint32_t tool_triangles, const FrameCapacity& capacity,
                                         FrameBuffers& buffers) const {
  const std::uint64_t statics = capacity.lists[kListContactStatics], slot_boxes = (statics + kSlotBox - 1) / kSlotBox;
  const std::uint64_t heights = refined_ ? capacity.lists[kListSamples] : statics;
  const std::uint64_t refined = refined_ ? 1 : 0;   // what `paper` leaves out gets the smallest buffer there is
  const std::uint64_t needles = capacity.lists[kListNeedleVertices];
  for (const BufferPlan& plan : std::initializer_list<BufferPlan>{
           {kBindResponseState, "response state", sizeof(ResponseState), false, BufferKind::kUpload},
           {kBindAreas, "contact areas", kMaxFrameAreas * sizeof(AreaWork), false, BufferKind::kUpload},
           {kBindSlots, "slots of contact triangles", statics * sizeof(SlotWork), false, BufferKind::kUpload},
           {kBindParents, "union-find of contact triangles", statics * (plan_.zones ? 2 : 1) * sizeof(std::uint32_t)},
           {kBindMobileWork, "tool triangles of areas", tool_triangles * std::uint64_t{sizeof(MobileWork)}},
           {kBindHeights, "heights", heights * sizeof(std::uint32_t)},
           {kBindFades, "fades of heights", refined * heights * sizeof(std::uint32_t)},
           {kBindHeldOverlap, "overlaps with held areas", refined * kMaxFrameAreas * kMaxFrameAreas * sizeof(std::uint32_t), true},
           {kBindMobileTiles, "tiles of tool samples", capacity.lists[kListMobileTiles] * std::uint64_t{sizeof(MobileTile)}},
           {kBindSlotBoxes, "boxes of contact triangles", refined * slot_boxes * sizeof(LatticeBox)},
           {kBindNeedleTable, "table of needle vertices", std::bit_ceil(std::uint64_t{capacity.needle_table}) * sizeof(std::uint32_t), true},
           {kBindNeedleVertices, "needle vertices", needles * sizeof(NeedleVertex)},
       })
    if (auto made = plan.table ? buffers.make_table(device, plan.binding, plan.what, plan.bytes)
                               : buffers.make(device, plan.binding, plan.what, plan.bytes, plan.kind);
        !made)
      return made.error();
  return {};
}

Result<FrameResponse> FrameResponse::create(VulkanDevice& device, bool refined, bool walks, const Plan& plan) {
  FrameResponse out;
  out.plan_ = plan;
  const std::vector<SpecConstant> left_out = plan_constants(plan);
  const auto with_plan = [&](std::span<const SpecConstant> constants) {
    std::vector<SpecConstant> all(constants.begin(), constants.end());
    all.insert(all.end(), left_out.begin(), left_out.end());
    return all;
  };
  out.refined_ = refined;
  out.walks_ = walks;
  const std::array<SpecConstant, 4> constants = {{{0, refined ? 1u : 0u}, {1, 0u}, {2, walks ? 1u : 0u}, {3, 0u}}};
  const std::array<SpecConstant, 2> numbering = {{{0, refined ? 1u : 0u}, {1, 1u}}};
  struct ShaderPlan {
    FrameShader& shader;
    const ShaderCode& code;
    bool only_refined = false, only_paper = false, kept = true;
  };
  for (const ShaderPlan& made_for : std::initializer_list<ShaderPlan>{
           {out.begin_, spirv::response_begin},
           {out.areas_begin_, spirv::areas_begin},
           {out.areas_join_, spirv::areas_join},
           {out.samples_count_, spirv::samples_count, true},
           {out.areas_number_, spirv::areas_number},
           {out.areas_gather_, spirv::areas_gather},
           {out.held_count_, spirv::held_count, true},
           {out.areas_associate_, spirv::areas_associate},
           {out.areas_first_, spirv::areas_first},
           {out.mobile_tiles_, spirv::mobile_tiles, true},
           {out.mobile_samples_, spirv::mobile_samples, true},
           {out.mobile_normals_, spirv::mobile_normals},
           {out.areas_direct_, spirv::areas_direct},
           {out.nearest_distance_, spirv::nearest_find, true},
           {out.areas_settle_, spirv::areas_settle, true},
           {out.heights_trace_, spirv::heights_trace, true},
           {out.centroids_trace_, spirv::centroids_trace, false, true},
           {out.heights_sum_, spirv::heights_sum},
           {out.areas_follow_, spirv::areas_follow, true},
           {out.pierce_boxes_, spirv::pierce_boxes, true},
           {out.pierce_find_, spirv::pierce_find, true},
           {out.needle_pairs_, spirv::needle_pairs, true},
           {out.needle_trace_, spirv::needle_trace, true},
           {out.points_sum_, spirv::points_sum, false, true, plan.contact_point},
           {out.swallow_march_, spirv::swallow_march, true, false, plan.imt},
           {out.areas_result_, spirv::areas_result},
       }) {
    if (!made_for.kept || (refined ? made_for.only_paper : made_for.only_refined)) continue;
    auto made = make_frame_shader(device, made_for.code, 0, with_plan(constants));
    if (!made) return made.error();
    made_for.shader = std::move(*made);
  }
  if (walks) {
    const std::array<SpecConstant, 4> listed = {{{0, 1u}, {1, 0u}, {2, 1u}, {3, 1u}}};
    auto made = make_frame_shader(device, spirv::heights_trace, 0, with_plan(listed));
    if (!made) return made.error();
    out.heights_listed_ = std::move(*made);
  }
  if (refined) {
    auto made = make_frame_shader(device, spirv::nearest_find, 0, with_plan(numbering));
    if (!made) return made.error();
    out.nearest_number_ = std::move(*made);
  }
  return out;
}

// Areas, zones, boxes, sums of static normals, members.
void FrameResponse::record_areas(FrameRecorder& recorder) const {
  recorder.stage("areas");
  recorder.run_dispatch(begin_, kDispatchContactOne);
  recorder.run_dispatch(areas_begin_, kDispatchContactStatics);
  recorder.barrier();
  recorder.run_dispatch(areas_join_, kDispatchContactStatics);
  if (refined_) recorder.run_dispatch(samples_count_, kDispatchSamples);
  recorder.barrier();
  recorder.run_dispatch(areas_number_, kDispatchContactStatics);
  recorder.barrier();
  recorder.run_dispatch(areas_gather_, kDispatchContactStatics);
  recorder.barrier();
  if (refined_) recorder.run_dispatch(held_count_, kDispatchHeldStatics);
  recorder.run_dispatch(areas_associate_, kDispatchContactMobiles);
  recorder.close({kListMembers});
  recorder.stage("directions");
  recorder.run_dispatch(areas_first_, kDispatchContactOne);
  recorder.barrier();
}

void FrameResponse::record_directions(FrameRecorder& recorder) const {
  // Normals of the tool, where an area's first rule needs them.
  recorder.run_dispatch(mobile_tiles_, kDispatchMembers);
  recorder.close({kListMobileTiles});
  recorder.run_groups(mobile_samples_, kListMobileTiles);
  recorder.barrier();
  recorder.run_dispatch(mobile_normals_, kDispatchMembers);
  recorder.barrier();
  recorder.run_dispatch(areas_direct_, kDispatchContactOne);
  recorder.barrier();
  // Nearest V_ext voxels, where nothing else gave a direction.
  recorder.run_dispatch(nearest_distance_, kDispatchNearest);
  recorder.barrier();
  recorder.run_dispatch(nearest_number_, kDispatchNearest);
  recorder.barrier();
  recorder.run_dispatch(areas_settle_, kDispatchNearestOne);
  recorder.barrier();
  if (!plan_.imt) return;
  recorder.stage("swallowed");
  recorder.run_dispatch(swallow_march_, kDispatchSwallowed);
}

void FrameResponse::record_heights(FrameRecorder& recorder, const FrameShader& trace) const {
  recorder.stage("rays");
  recorder.run_dispatch(trace, kDispatchSamples);
  recorder.barrier();
  recorder.run_dispatch(heights_sum_, kDispatchHeightRuns);
  recorder.barrier();
  recorder.stage("follow");
  recorder.run_dispatch(areas_follow_, kDispatchContactOne);
  recorder.barrier();
  recorder.run_dispatch(pierce_boxes_, kDispatchPierceBoxes);
  recorder.barrier();
  recorder.run_dispatch(needle_pairs_, kDispatchNeedlePairs);
  recorder.close({kListNeedleVertices});
  recorder.run_groups(needle_trace_, kListNeedleVertices);
  recorder.run_dispatch(pierce_find_, kDispatchPierce);
  recorder.close({kListPierces});
}

void FrameResponse::record_paper(FrameRecorder& recorder) const {
  recorder.run_dispatch(mobile_normals_, kDispatchMembers);
  if (plan_.contact_point) recorder.run_dispatch(points_sum_, kDispatchTouchedVoxels);
  recorder.barrier();
  recorder.run_dispatch(areas_direct_, kDispatchContactOne);
  recorder.barrier();
  recorder.stage("rays");
  recorder.run_dispatch(centroids_trace_, kDispatchContactStatics);
  recorder.barrier();
  recorder.run_dispatch(heights_sum_, kDispatchHeightRuns);
  recorder.barrier();
}

void FrameResponse::record(FrameRecorder& recorder) const {
  record_areas(recorder);
  if (refined_) {
    record_directions(recorder);
    record_heights(recorder, heights_trace_);
  } else {
    record_paper(recorder);
  }
  recorder.run_dispatch(areas_result_, kDispatchContactOne);
}

void FrameResponse::record_after_areas(FrameRecorder& recorder) const {
  record_heights(recorder, walks_ ? heights_listed_ : heights_trace_);
  recorder.run_dispatch(areas_result_, kDispatchContactOne);
}

}  // namespace palpate

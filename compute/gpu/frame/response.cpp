#include "compute/gpu/frame/response.h"

#include <vector>

#include "compute/gpu/frame/plan.h"
#include "shaders/code.h"

namespace palpate {
namespace {

using namespace gpu;

/// One buffer of the response.
struct BufferPlan {
  std::int32_t binding;
  const char* what;
  std::uint64_t bytes;
};

}  // namespace

Result<void> FrameResponse::make_buffers(VulkanDevice& device, std::uint32_t tool_triangles,
                                         const FrameCapacity& capacity, FrameBuffers& buffers) const {
  const std::uint64_t statics = capacity.lists[kListContactStatics];
  for (const BufferPlan& plan : std::initializer_list<BufferPlan>{
           {kBindResponseState, "response state", sizeof(ResponseState)},
           {kBindAreas, "contact areas", kMaxFrameAreas * sizeof(AreaWork)},
           {kBindSlotAreas, "areas of contact triangles", statics * sizeof(std::uint32_t)},
           {kBindParents, "union-find of contact triangles",
            statics * (plan_.zones ? 2 : 1) * sizeof(std::uint32_t)},
           {kBindMobileAreas, "areas of tool triangles",
            tool_triangles * std::uint64_t{sizeof(std::uint32_t)}},
       })
    if (auto made = buffers.make(device, plan.binding, plan.what, plan.bytes, BufferKind::kDevice); !made)
      return made.error();
  return {};
}

Result<FrameResponse> FrameResponse::create(VulkanDevice& device, const Plan& plan) {
  FrameResponse out;
  out.plan_ = plan;
  const std::vector<SpecConstant> constants = plan_constants(plan);
  struct ShaderPlan {
    FrameShader& shader;
    const ShaderCode& code;
    bool kept = true;
  };
  for (const ShaderPlan& made_for : std::initializer_list<ShaderPlan>{
           {out.begin_, spirv::response_begin},
           {out.areas_begin_, spirv::areas_begin},
           {out.areas_join_, spirv::areas_join},
           {out.areas_number_, spirv::areas_number},
           {out.areas_gather_, spirv::areas_gather},
           {out.areas_associate_, spirv::areas_associate},
           {out.areas_first_, spirv::areas_first},
           {out.mobile_normals_, spirv::mobile_normals},
           {out.areas_direct_, spirv::areas_direct},
           {out.centroids_trace_, spirv::centroids_trace},
           {out.points_sum_, spirv::points_sum, plan.contact_point},
           {out.areas_result_, spirv::areas_result},
       }) {
    if (!made_for.kept) continue;
    auto made = make_frame_shader(device, made_for.code, 0, constants);
    if (!made) return made.error();
    made_for.shader = std::move(*made);
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
  recorder.barrier();
  recorder.run_dispatch(areas_number_, kDispatchContactStatics);
  recorder.barrier();
  recorder.run_dispatch(areas_gather_, kDispatchContactStatics);
  recorder.barrier();
  recorder.run_dispatch(areas_associate_, kDispatchContactMobiles);
  recorder.barrier();
  recorder.stage("directions");
  recorder.run_dispatch(areas_first_, kDispatchContactOne);
  recorder.barrier();
}

void FrameResponse::record(FrameRecorder& recorder) const {
  record_areas(recorder);
  recorder.run_dispatch(mobile_normals_, kDispatchAreaMembers);
  if (plan_.contact_point) recorder.run_dispatch(points_sum_, kDispatchTouchedVoxels);
  recorder.barrier();
  recorder.run_dispatch(areas_direct_, kDispatchContactOne);
  recorder.barrier();
  recorder.stage("rays");
  recorder.run_dispatch(centroids_trace_, kDispatchContactStatics);
  recorder.barrier();
  recorder.run_dispatch(areas_result_, kDispatchContactOne);
}

}  // namespace palpate

#pragma once
#include <cstdint>

#include "compute/gpu/frame/capacity.h"
#include "compute/gpu/frame/recorder.h"
#include "compute/vulkan/device.h"
#include "model/result.h"
#include "model/scene/plan.h"
#include "shaders/shared/frame_response.h"

namespace palpate {

/// `paper`: the response half of a frame, areas, n_c, heights, sums (docs/EXACTNESS.md sections 5 to 7), from
/// the lists that detection leaves. Owns pipelines; its buffers live in FrameBuffers. Allocates when made,
/// not when a frame runs.
class FrameResponse {
 public:
  /// Makes the pipelines of what `plan` keeps.
  static Result<FrameResponse> create(VulkanDevice& device, const Plan& plan);

  /// Makes its buffers in `buffers`; those that are large enough already stay. Before the first record(), and
  /// again when the capacity has grown. Error: one buffer is beyond a limit, or out of memory.
  Result<void> make_buffers(VulkanDevice& device, std::uint32_t tool_triangles, const FrameCapacity& capacity,
                            FrameBuffers& buffers) const;

  /// Records every dispatch; all of them have no groups in a frame without contact. Goes after
  /// set_decide.comp, and ends with a barrier due.
  void record(FrameRecorder& recorder) const;

 private:
  void record_areas(FrameRecorder& recorder) const;

  Plan plan_;
  FrameShader begin_, areas_begin_, areas_join_, areas_number_, areas_gather_, areas_associate_, areas_first_,
      mobile_normals_, areas_direct_, centroids_trace_, points_sum_, areas_result_;
};

}  // namespace palpate

#pragma once
#include <cstdint>

#include "compute/frame_capacity.h"
#include "compute/frame_recorder.h"
#include "compute/vulkan_device.h"
#include "model/plan.h"
#include "model/result.h"
#include "shaders/shared/frame_response.h"

namespace palpate {

/// The response half of a frame: areas, n_c, heights, sums (docs/EXACTNESS.md sections 5 to 7), from the lists that detection
/// leaves. Owns pipelines; its buffers live in FrameBuffers. Allocates when made, not when a frame runs.
class FrameResponse {
 public:
  /// Makes the pipelines of what `plan` keeps. `walks`: PreparedScene::rays_walk().
  static Result<FrameResponse> create(VulkanDevice& device, bool refined, bool walks = false, const Plan& plan = {});

  /// Makes the buffers 72 and above in `buffers`; those that are large enough already stay. Before the first record(), and again when the
  /// capacity has grown. Error: one buffer is beyond a limit, or out of memory.
  Result<void> make_buffers(VulkanDevice& device, std::uint32_t tool_triangles, const FrameCapacity& capacity, FrameBuffers& buffers) const;

  /// Records every dispatch; all of them have no groups in a frame without contact. Goes after set_decide.comp, and ends with
  /// a barrier due.
  void record(FrameRecorder& recorder) const;
  /// The same for a frame whose areas and directions the host has written (compute/host_areas.h), and where rays walk their lists, too
  /// (compute/near_rays.h): rays and what follows. `refined`.
  void record_after_areas(FrameRecorder& recorder) const;

 private:
  void record_paper(FrameRecorder& recorder) const;
  void record_directions(FrameRecorder& recorder) const;
  void record_heights(FrameRecorder& recorder, const FrameShader& trace) const;
  void record_areas(FrameRecorder& recorder) const;

  bool refined_ = true, walks_ = false;
  Plan plan_;
  FrameShader begin_, areas_begin_, areas_join_, samples_count_, areas_number_, areas_gather_, held_count_, areas_associate_;
  FrameShader areas_first_, mobile_tiles_, mobile_samples_, mobile_normals_, areas_direct_, nearest_distance_, nearest_number_;
  FrameShader areas_settle_, heights_trace_, heights_listed_, centroids_trace_, heights_sum_, areas_follow_, pierce_boxes_, pierce_find_, needle_pairs_;
  FrameShader needle_trace_, points_sum_, swallow_march_, areas_result_;
};

}  // namespace palpate

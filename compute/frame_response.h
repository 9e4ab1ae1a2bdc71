#pragma once
#include <array>
#include <cstdint>

#include "compute/frame_recorder.h"
#include "compute/vulkan_device.h"
#include "model/result.h"
#include "shaders/shared/frame_response.h"

namespace palpate {

/// The response half of a frame: areas, n_c, heights, sums (docs/EXACTNESS.md sections 5 to 7), from the lists that detection
/// leaves. Owns pipelines; its buffers live in FrameBuffers. Allocates when made, not when a frame runs.
class FrameResponse {
 public:
  /// Sizes of what detection hands over.
  struct Sizes {
    bool refined = true;
    std::uint32_t tool_triangles = 0;
    std::uint32_t statics = 0;      ///< capacity of the list of C_s
    std::uint32_t samples = 0;      ///< capacity of the list of counting samples; `paper`: 0
    std::uint32_t held_areas = gpu::kMaxFrameAreas;   ///< most held areas that a query brings
  };

  /// Items that fit into one of the response's own lists; for FrameList::capacity.
  struct ListCapacity {
    std::uint32_t list;
    std::uint32_t items;
  };
  static constexpr std::array<ListCapacity, 2> kCapacities = {
      {{gpu::kListMobileTiles, 1u << 18}, {gpu::kListNeedleVertices, gpu::kNeedleTable}}};

  /// Makes the buffers 72 and above in `buffers`, and the pipelines. Error: out of memory, device lost.
  static Result<FrameResponse> create(VulkanDevice& device, const Sizes& sizes, FrameBuffers& buffers);

  /// Records every dispatch; all of them have no groups in a frame without contact. Goes after set_decide.comp, and ends with
  /// a barrier due.
  void record(FrameRecorder& recorder) const;

  /// Names what an overflow bit of FrameState::overflow or overflow_other means, for Contacts::truncated_capacity; null: not ours.
  static const char* overflow_name(std::uint32_t overflow, std::uint32_t overflow_other);

 private:
  void record_paper(FrameRecorder& recorder) const;
  void record_refined(FrameRecorder& recorder) const;
  void record_areas(FrameRecorder& recorder) const;

  bool refined_ = true;
  FrameShader begin_, areas_begin_, areas_join_, samples_count_, areas_number_, areas_gather_, held_count_, areas_associate_;
  FrameShader areas_first_, mobile_tiles_, mobile_samples_, mobile_normals_, areas_direct_, nearest_distance_, nearest_number_;
  FrameShader areas_settle_, heights_trace_, heights_sum_, areas_follow_, pierce_boxes_, pierce_find_, needle_pairs_;
  FrameShader needle_trace_, points_sum_, swallow_march_, areas_result_;
};

}  // namespace palpate

#pragma once
#include <cstdint>
#include <memory>
#include <vector>

#include "compute/gpu/frame/capacity.h"
#include "compute/gpu/frame/recorder.h"
#include "compute/gpu/prepare/prepared_scene.h"
#include "compute/vulkan/device.h"
#include "model/result.h"
#include "model/scene/plan.h"
#include "model/scene/scene_geometry.h"

namespace palpate {

/// The first half of a frame: from the pose to the contact sets, pairs and counting samples
/// (docs/EXACTNESS.md sections 3, 4), and the frame's last step, which empties what it filled. Makes its own
/// buffers and pipelines.
class FrameDetection {
 public:
  /// `batch`: of a batch (shaders/shared/frame_batch.h), `refined` only.
  static std::unique_ptr<FrameDetection> make(const SceneGeometry& geometry, const PreparedScene& scene,
                                              const Plan& plan, bool batch = false);
  /// Whether pose, static triangle and tool triangle together fit a key of a batch of so many poses.
  static bool keys_fit(const gpu::SceneConstants& scene, std::uint32_t poses);

  /// Asks for the pipelines, which are then made beside what follows. Before record().
  Result<void> make_shaders(VulkanDevice& device);
  /// Makes the buffers of the lists and tables into `buffers`; those that are large enough already stay.
  /// Before the first record(), and again when the capacity has grown. Error: one buffer is beyond a limit,
  /// or out of memory.
  Result<void> make_buffers(VulkanDevice& device, const SceneGeometry& geometry, const PreparedScene& scene,
                            const FrameCapacity& capacity, FrameBuffers& buffers) const;

  /// From the pose to the lists of C_s, C_m, samples, and frame_state; ends with a barrier due.
  void record(FrameRecorder& recorder) const;
  /// Workgroups of the first dispatch that a pose takes.
  std::uint32_t cull_groups() const;
  /// `paper`: names the sets, and whether there is contact; ends with a barrier due.
  void record_names(FrameRecorder& recorder) const;
  /// `paper`, after the response: counts to the host, tables back to 0.
  void record_end(FrameRecorder& recorder) const;
  /// First of all in a batch: lists, state and group counts as a batch finds them.
  static void record_anew(FrameRecorder& recorder);
  /// Ids of the tool's triangles in the order of clusters and runs.
  const std::vector<std::uint32_t>& order() const { return order_; }

 private:
  FrameDetection() = default;
  Result<void> upload_records(VulkanDevice& device, const LatticeMesh& tool, const VulkanBuffer& to) const;
  Result<void> upload_bounds(VulkanDevice& device, const LatticeMesh& tool, const VulkanBuffer& to) const;
  Result<void> upload_places(VulkanDevice& device, const PreparedScene& scene, const VulkanBuffer& to) const;

  Plan plan_;
  bool batch_ = false;
  bool refined_ = false;
  bool inside_ =
      false;  ///< samples are asked whether they lie inside the tool: refined, and it has an inside
  bool closed_ = false;  ///< the tool's surface, in `refined`: open samples ask for the winding
  bool listed_ = false;  ///< samples were listed by preparation …
  bool wide_ = false;    ///< … three words each
  WorkCut cut_{};
  bool has_near_ = false;  ///< tool_near says something
  std::vector<std::uint32_t> order_;
  FrameShader broad_phase_, voxel_touch_, pair_test_, tool_clusters_place_, sample_scan_, sample_listed_,
      sample_walk_, set_decide_, set_name_, frame_result_;
};

}  // namespace palpate

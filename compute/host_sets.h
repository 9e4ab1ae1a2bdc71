#pragma once
#include <cstdint>
#include <span>
#include <vector>

#include "compute/host_partition.h"
#include "compute/near_lists.h"
#include "compute/pair_filter.h"
#include "compute/posed_tool.h"
#include "compute/prepared_scene.h"
#include "model/scene_geometry.h"

namespace palpate {

/// What detection finds at a pose: frame_state and the lists that the device would leave, in any order.
struct FoundSets {
  gpu::FrameState state{};
  std::vector<gpu::StaticResult> statics;   ///< C_s by slot
  std::vector<gpu::MobileResult> mobiles;   ///< C_m
  std::vector<gpu::FrameSample> samples;    ///< that count
  std::vector<gpu::ContactPair> pairs;
};

/// Decides on the host what the device's shaders decide about the lists of what is near (docs/EXACTNESS.md sections 3 and 4): sets, pairs and
/// counting samples of a closed tool in `refined`. The same questions, answered exactly, so the same bits.
/// One thread; make() keeps references to its arguments; decide() allocates only when a contact is larger than all before.
class HostSets {
 public:
  /// `order`: ids of the tool's triangles by place. Only where rays walk.
  static Result<HostSets> make(VulkanDevice& device, const SceneGeometry& geometry, const PreparedScene& scene, std::span<const std::uint32_t> order);

  /// `slot_of`: by static id; the slots of C_s are written there. False: C_s has more than `most_statics`; `out` is then half written.
  bool decide(PosedTool& tool, const NearLists& near, std::span<std::uint32_t> slot_of, std::size_t most_statics, FoundSets& out);

 private:
  void decide_pairs(PosedTool& tool, const NearLists& near, std::span<std::uint32_t> slot_of, FoundSets& out);
  void decide_voxels(PosedTool& tool, const NearLists& near, FoundSets& out);
  void mark_static(std::uint32_t id, std::uint32_t bit, std::span<std::uint32_t> slot_of, FoundSets& out) const;
  void mark_mobile(std::uint32_t id, std::uint32_t bit, FoundSets& out);
  bool marked(std::uint32_t id, std::uint32_t bit, const FoundSets& out) const;
  Int3 tool_point(const LatticePose& pose, const Int3& point) const;
  bool walks_out(PosedTool& tool, const Int3& point) const;
  bool inside(PosedTool& tool, const Int3& point) const;
  template <class Take>
  void scan(const gpu::SampleChunk& chunk, Take&& take) const;

  const SceneGeometry* geometry_ = nullptr;
  std::span<const std::uint32_t> order_;
  HostPartition mockup_, fine_;
  PairFilter filter_;
  HostCopy<std::uint32_t> fine_exit_;
  std::vector<std::uint8_t> touched_;           ///< by V_bnd voxel; 0 between frames
  std::vector<std::uint32_t> touched_voxels_;   ///< of this frame
  std::vector<std::uint32_t> mobile_at_;        ///< by tool triangle: its place in C_m, where that has it there
};

}  // namespace palpate

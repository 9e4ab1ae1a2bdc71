#pragma once
#include <algorithm>
#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <vector>

#include "compute/frame_decode.h"
#include "compute/host_areas.h"
#include "compute/host_follow.h"
#include "compute/host_heights.h"
#include "compute/host_sets.h"
#include "compute/near_lists.h"
#include "compute/posed_tool.h"

namespace palpate {

/// A whole small contact on the host, from the lists of what is near to the sums: where the device is the host's own processor, a few hundred
/// exact questions are sooner answered one after the other than in forty dispatches (docs/PERFORMANCE.md). Large, swallowed and other rare
/// contacts are left to the device, whose shaders say the same bits. One thread; make() keeps references to its arguments; solve() allocates
/// only when a contact is larger than all before.
class HostContact {
 public:
  /// `areas` and `rays` outlive this. Only in `refined`, where rays walk.
  static Result<std::unique_ptr<HostContact>> make(VulkanDevice& device, const SceneGeometry& geometry, const PreparedScene& scene,
                                                   const RunTree& runs, HostAreas& areas, NearRays& rays);

  /// False: left to the device. `stage(name)` is called at the end of each stage.
  template <class Stage>
  bool solve(PosedTool& tool, const Held* held, const NearLists& near, Stage stage) {
    if (std::max({near.touch.count, near.pairs.count, near.inside.count, near.open.count, near.samples.count}) > kMostCandidates) return false;
    if (!decide(tool, near)) return false;
    stage("sets");
    if (found_.state.contact == 0) return finish(0);
    if (found_.state.swallowed != 0 || !join(tool, held)) return false;
    stage("areas");
    if (!trace(tool)) return false;
    stage("rays");
    if (!follow(tool)) return false;
    stage("follow");
    return finish(answer_.areas);
  }
  /// After solve().
  FrameOutput output() const { return {&result_, found_.statics.data(), found_.mobiles.data(), members_.data(), pierces_.data()}; }
  std::span<const gpu::ContactPair> pairs() const { return found_.pairs; }

  static constexpr std::uint32_t kMostCandidates = 1u << 16;   ///< of a kind, beyond which the device takes over (chosen)

 private:
  HostContact(const SceneGeometry& geometry, HostAreas& areas, NearRays& rays, const RunTree& runs)
      : areas_(areas), heights_(geometry, rays, runs), follow_(geometry) {}
  bool decide(PosedTool& tool, const NearLists& near);
  bool join(PosedTool& tool, const Held* held);
  bool trace(PosedTool& tool);
  bool follow(PosedTool& tool);
  bool finish(std::uint32_t areas);

  HostAreas& areas_;
  HostSets sets_;
  HostHeights heights_;
  HostFollow follow_;
  FoundSets found_;
  ContactLists lists_{};
  HostAreas::Answer answer_;
  std::vector<gpu::AreaWork> work_;
  std::vector<gpu::SlotWork> slots_;
  std::vector<gpu::AreaMember> members_;
  std::vector<RisenSample> risen_;
  std::vector<gpu::AreaPierce> pierces_;
  gpu::FrameResult result_{};
};

}  // namespace palpate

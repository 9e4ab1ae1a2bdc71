#pragma once
#include <cstddef>
#include <cstdint>
#include <map>
#include <memory>
#include <span>
#include <string>

#include "compute/gpu/prepare/prepared_scene.h"
#include "compute/vulkan/device.h"
#include "model/collision_backend.h"
#include "model/contact/contacts.h"
#include "model/lattice/lattice.h"
#include "model/result.h"
#include "model/scene/scene_geometry.h"

namespace palpate {

/// A pose of a batch, and where its answer goes.
struct GridPose {
  LatticePose pose;
  std::uint32_t coarser = 0;  ///< as Ignored::coarser
  Contacts* out = nullptr;
};

/// Many poses in one submission, of as many dispatches as a lone frame has: the pose is a dimension of the
/// work, not of its commands (shaders/shared/frame_batch.h). Profile `refined`. One thread at a time.
class PoseGrid {
 public:
  virtual ~PoseGrid() = default;
  /// All arguments outlive it. `first_capacity` is GpuOptions::first_capacity, of the lists of all poses.
  /// Error: it is not for such a scene, or there is no memory for it.
  static Result<std::unique_ptr<PoseGrid>> create(VulkanDevice& device, const SceneGeometry& geometry,
                                                  const PreparedScene& scene,
                                                  const std::map<std::string, std::uint32_t>& first_capacity,
                                                  const Plan& plan);
  /// How many poses a submission takes; may become fewer where lists can't grow.
  virtual std::size_t most() const = 0;
  /// Answers up to most() poses. One that the lists had no room for is `truncated`, for a lone frame to
  /// answer; they have grown when this comes back. Error: the device failed, and no answer counts.
  virtual Result<void> ask(std::span<const GridPose> poses) = 0;
  /// Whether the tool touches at up to most() poses: bits[i] is 0 or 1, or kOpen where the lists had no room,
  /// for a lone frame to answer. Error: as ask().
  virtual Result<void> touch(std::span<const LatticePose> poses, std::span<std::uint8_t> bits) = 0;
  static constexpr std::uint8_t kOpen = 2;
  /// As Frame::work and Frame::memory_bytes.
  virtual DeviceWork work() const = 0;
  virtual std::uint64_t memory_bytes() const = 0;
};

}  // namespace palpate

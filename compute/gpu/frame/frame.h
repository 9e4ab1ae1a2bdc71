#pragma once
#include <cstdint>
#include <map>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "compute/gpu/prepare/prepared_scene.h"
#include "compute/vulkan/device.h"
#include "model/collision_backend.h"
#include "model/contact/contacts.h"
#include "model/lattice/lattice.h"
#include "model/result.h"
#include "model/scene/scene_geometry.h"

namespace palpate {

/// One query at a time on a prepared scene: buffers, pipelines and the recorded commands of a frame.
class Frame {
 public:
  virtual ~Frame() = default;
  /// All arguments must outlive the frame.
  /// `first_capacity` is GpuOptions::first_capacity. `plan`: what it leaves out has no pipeline, dispatch or
  /// buffer.
  static Result<std::unique_ptr<Frame>> create(VulkanDevice& device, const SceneGeometry& geometry,
                                               const PreparedScene& scene,
                                               const std::map<std::string, std::uint32_t>& first_capacity,
                                               const Plan& plan = {});
  /// As CollisionBackend::finish_preparing, query and enlarge.
  virtual Result<void> finish() = 0;
  virtual Result<void> query(const LatticePose& pose, const Ignored* ignored, Contacts& out) = 0;
  virtual Result<void> enlarge() = 0;
  /// As CollisionBackend::time_stages.
  virtual Result<void> time_stages(bool wanted) = 0;
  /// As CollisionBackend::pairs.
  virtual Result<std::vector<std::pair<std::uint32_t, std::uint32_t>>> pairs() const = 0;
  /// As CollisionBackend::device_work, of this frame alone.
  virtual DeviceWork work() const = 0;
  /// Bytes of device memory that the frame itself holds.
  virtual std::uint64_t memory_bytes() const = 0;
  /// Device memory of frame and scene together, by stage of `palpate plan`.
  virtual std::vector<StageMemory> memory_by_stage() const = 0;
};

}  // namespace palpate

#pragma once
#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <vector>

#include "compute/gpu/frame/frame.h"
#include "compute/gpu/gpu_backend.h"
#include "compute/gpu/prepare/prepared_scene.h"
#include "compute/vulkan/device.h"
#include "model/pose_threads.h"

namespace palpate {

/// Frames that answer poses of a batch beside the caller's, each on a thread of its own, all on one scene.
/// Where what a frame does runs on the thread that asks (lavapipe), each has a device, too, and the devices
/// share the scene in host memory (VulkanDevice::shares_memory): a thread is a core's worth. Elsewhere all
/// frames are the one device's: while one waits for it others search, so that several are under way. One
/// caller at a time.
class BatchWorkers {
 public:
  /// `helpers` threads on `device`, or each on a device of its own where it is null; device, geometry and
  /// scene outlive this. Reads the environment as make_gpu_backend does. Takes about as long as the first
  /// frame.
  static Result<std::unique_ptr<BatchWorkers>> create(const GpuOptions& options, VulkanDevice* device,
                                                      const SceneGeometry& geometry,
                                                      const PreparedScene& scene, const Plan& plan,
                                                      unsigned helpers);
  ~BatchWorkers();
  BatchWorkers(const BatchWorkers&) = delete;
  BatchWorkers& operator=(const BatchWorkers&) = delete;

  /// As PoseThreads::share: `own` on this thread, the helpers beside it. What a frame has too little room for
  /// is enlarged and asked again.
  Result<void> share(Frame& own, std::size_t count, const PoseWork& work);

  std::uint64_t memory_bytes() const;
  /// Of the helpers' frames.
  DeviceWork work() const;

 private:
  struct Helper {
    std::unique_ptr<VulkanDevice> device;  ///< where each has one, with …
    PreparedScene scene;                   ///< … what it has of the scene
    std::unique_ptr<Frame> frame;
    std::unique_ptr<PoseQuery> asked;  ///< the frame, enlarged where it has to be
  };
  BatchWorkers() = default;

  std::vector<std::unique_ptr<Helper>> helpers_;
  std::optional<PoseThreads> threads_;  ///< of the helpers
};

}  // namespace palpate

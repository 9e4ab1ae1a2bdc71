#pragma once
#include <cstddef>
#include <cstdint>
#include <memory>
#include <optional>
#include <vector>

#include "compute/gpu/frame/frame.h"
#include "compute/gpu/frame/pose_grid.h"
#include "compute/gpu/gpu_backend.h"
#include "compute/gpu/prepare/prepared_scene.h"
#include "compute/vulkan/device.h"
#include "model/pose_threads.h"

namespace palpate {

/// What answers poses of a batch on the caller's thread and beside it, each on a thread of its own, all on
/// one scene: a lone frame, and in `refined` a grid of many poses. Where what a device does runs on the
/// thread that asks (lavapipe), each has a device, too, and the devices share the scene in host memory
/// (VulkanDevice::shares_memory): a thread is a core's worth. Elsewhere all are the one device's: while one
/// waits for it others write poses and read answers, so that several submissions are under way. One caller at
/// a time.
class BatchWorkers {
 public:
  /// `helpers` threads; each with a device of its own, or on `device` where `own_devices` is not. `own`: the
  /// caller's frame, on `device`. Device, geometry, scene and `own` outlive this. Reads the environment as
  /// make_gpu_backend does. Takes about as long as the first frame.
  static Result<std::unique_ptr<BatchWorkers>> create(const GpuOptions& options, VulkanDevice& device,
                                                      bool own_devices, const SceneGeometry& geometry,
                                                      const PreparedScene& scene, const Plan& plan,
                                                      Frame& own, unsigned helpers);
  ~BatchWorkers();
  BatchWorkers(const BatchWorkers&) = delete;
  BatchWorkers& operator=(const BatchWorkers&) = delete;

  /// As PoseThreads::share. What a frame has too little room for is enlarged and asked again.
  Result<void> share(std::size_t count, const PoseWork& work);
  /// As CollisionBackend::poses_together.
  std::size_t poses_together(std::size_t count) const;

  std::uint64_t memory_bytes() const;
  /// Of all of them but the caller's frame.
  DeviceWork work() const;

 private:
  class Asked;
  struct Helper {
    std::unique_ptr<VulkanDevice> device;  ///< where each has one, with …
    PreparedScene scene;                   ///< … what it has of the scene
    std::unique_ptr<Frame> frame;
    std::unique_ptr<Asked> asked;  ///< the frame, enlarged where it has to be, and the grid
  };
  BatchWorkers();

  bool own_devices_ = false;
  std::unique_ptr<Asked> own_;  ///< on the caller's thread
  std::vector<std::unique_ptr<Helper>> helpers_;
  std::optional<PoseThreads> threads_;  ///< of the helpers
};

}  // namespace palpate

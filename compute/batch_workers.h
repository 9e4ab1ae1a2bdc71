#pragma once
#include <condition_variable>
#include <cstdint>
#include <functional>
#include <memory>
#include <mutex>
#include <span>
#include <thread>
#include <vector>

#include "compute/frame.h"
#include "compute/gpu_backend.h"
#include "compute/prepared_scene.h"
#include "compute/vulkan_device.h"

namespace palpate {

/// Threads that answer poses of a batch beside the caller's, each with a frame on a device of its own, all on one scene in shared host
/// memory (VulkanDevice::shares_memory). What a frame does on lavapipe runs on the thread that asks, so that a thread is a core's worth.
/// One caller at a time.
class BatchWorkers {
 public:
  /// `helpers` threads; geometry and scene outlive this. Reads the environment as make_gpu_backend does. Takes about as long as the first frame.
  static Result<std::unique_ptr<BatchWorkers>> create(const GpuOptions& options, const SceneGeometry& geometry, const PreparedScene& scene,
                                                      const Plan& plan, unsigned helpers);
  ~BatchWorkers();
  BatchWorkers(const BatchWorkers&) = delete;
  BatchWorkers& operator=(const BatchWorkers&) = delete;

  /// Answers all poses: `own` on this thread, the helpers beside it. After an error, poses that nobody has begun are not answered.
  Result<void> answer(Frame& own, std::span<const LatticePose> poses, std::span<Contacts> out);

  std::uint64_t memory_bytes() const;

 private:
  struct Helper {
    std::unique_ptr<VulkanDevice> device;
    PreparedScene scene;
    std::unique_ptr<Frame> frame;
    std::thread thread;
  };
  BatchWorkers() = default;
  void work(Frame& frame);
  void serve(Frame& frame);

  std::vector<std::unique_ptr<Helper>> helpers_;
  std::mutex mutex_;
  std::condition_variable begun_, finished_;
  bool stop_ = false;
  std::uint64_t round_ = 0;       ///< batches begun
  std::size_t busy_ = 0;          ///< helpers at work on it
  std::span<const LatticePose> poses_;
  std::span<Contacts> out_;
  std::size_t next_ = 0;
  Result<void> outcome_;
};

}  // namespace palpate

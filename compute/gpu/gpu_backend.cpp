#include "compute/gpu/gpu_backend.h"

#include <algorithm>
#include <chrono>
#include <cstdlib>
#include <optional>
#include <thread>
#include <utility>

#include "compute/gpu/batch_workers.h"
#include "compute/gpu/frame/frame.h"
#include "compute/gpu/prepare/cache.h"
#include "compute/gpu/prepare/prepared_scene.h"
#include "compute/scene/estimate.h"
#include "compute/vulkan/device.h"
#include "model/processors.h"

namespace palpate {
namespace {

// Each takes a frame's memory (chosen), …
constexpr unsigned kMostHelpers = 7;
// … and on a device that all share a grid's, hundreds of megabytes: as many as keep it busy.
constexpr unsigned kMostGrids = 3;

/// The device engine: a device, the scene on it, and the frame that answers queries.
class GpuBackend final : public CollisionBackend {
 public:
  GpuBackend(std::unique_ptr<VulkanDevice> device, const GpuOptions& options)
      : device_(std::move(device)), options_(options) {}

  Result<void> prepare(const SceneGeometry& geometry, const Plan& plan, const Progress& progress) override {
    workers_.reset();
    no_workers_ = false;
    shared_ = 0;
    frame_.reset();
    scene_.reset();
    geometry_ = &geometry;
    if (auto found = scene_for(geometry, plan, progress); !found) return found;
    return make_frame(plan);
  }

  Result<void> replan(const Plan& plan) override {
    if (!scene_ || (plan.profile == Profile::kRefined) != (scene_->constants.refined != 0))
      return Error{ErrorCode::kInternal, "no scene has been prepared for this plan's profile"};
    workers_.reset();  // which asks the frame
    frame_.reset();    // two frames' lists may not fit
    no_workers_ = false;
    return make_frame(plan);
  }

  Result<void> finish_preparing() override {
    if (!frame_) return Error{ErrorCode::kInternal, "no scene has been prepared"};
    if (auto r = frame_->finish(); !r) return r;
    return device_->check_guards();
  }

  std::uint64_t preparation_bytes(const SceneGeometry& geometry, const Plan& plan) const override {
    return estimate_preparation(geometry, plan);
  }

  Result<void> query(const LatticePose& pose, const Ignored* ignored, Contacts& out) override {
    if (!frame_) return Error{ErrorCode::kInternal, "query before prepare"};
    if (auto r = frame_->query(pose, ignored, out); !r) return r;
    return device_->check_guards();
  }

  Result<void> share(std::size_t count, const PoseWork& work) override {
    if (!frame_) return Error{ErrorCode::kInternal, "query before prepare"};
    shared_ += count;
    if (shared_ >= kWorthThreads) set_helpers_up();
    if (!workers_) return CollisionBackend::share(count, work);
    if (auto done = workers_->share(count, work); !done) return done;
    return device_->check_guards();
  }

  bool time_stages(bool wanted) override { return frame_ && static_cast<bool>(frame_->time_stages(wanted)); }

  std::size_t poses_together(std::size_t count) override {
    if (frame_ && shared_ + count >= kWorthThreads) set_helpers_up();
    return workers_ ? workers_->poses_together(count) : 1;
  }

  Result<void> touches(std::span<const LatticePose> poses, std::span<std::uint8_t> bits) override {
    const std::size_t each = poses_together(poses.size());
    if (each <= 1) return CollisionBackend::touches(poses, bits);
    return share((poses.size() + each - 1) / each, [&](PoseQuery& asked, std::size_t i) {
      const std::size_t first = i * each, count = std::min(each, poses.size() - first);
      return asked.touch_together(poses.subspan(first, count), bits.subspan(first, count));
    });
  }

  Result<void> enlarge() override {
    if (!frame_) return Error{ErrorCode::kInternal, "enlarge before prepare"};
    return frame_->enlarge();
  }

  Result<VoxelPartition> partition(bool tool) const override {
    if (!scene_) return Error{ErrorCode::kInternal, "partition before prepare"};
    const auto read = read_partition(*device_, tool ? scene_->tool.partition : scene_->mockup.partition);
    if (!read) return read.error();
    return dense(*read);
  }

  Result<std::vector<std::pair<std::uint32_t, std::uint32_t>>> pairs() const override {
    if (!frame_) return Error{ErrorCode::kInternal, "pairs before prepare"};
    return frame_->pairs();
  }

  bool has_internal_voxels() const override { return scene_ && scene_->mockup.partition.has_internal; }
  std::string name() const override { return "gpu"; }
  std::string device() const override { return device_->name(); }
  std::uint64_t memory_bytes() const override {
    return (scene_ ? scene_->memory_bytes() : 0) + (frame_ ? frame_->memory_bytes() : 0) +
           (workers_ ? workers_->memory_bytes() : 0);
  }
  DeviceWork device_work() const override {
    DeviceWork sum = frame_ ? frame_->work() : DeviceWork{};
    if (workers_) sum += workers_->work();
    return sum;
  }
  std::vector<StageMemory> memory_by_stage() const override {
    return frame_ ? frame_->memory_by_stage() : std::vector<StageMemory>{};
  }

 private:
  Result<void> make_frame(const Plan& plan) {
    plan_ = plan;
    auto frame = Frame::create(*device_, *geometry_, *scene_, options_.first_capacity, plan);
    if (!frame) return frame.error();
    frame_ = std::move(*frame);
    return device_->check_guards();
  }

  /// Fills scene_, from the cache if it is there.
  Result<void> scene_for(const SceneGeometry& geometry, const Plan& plan, const Progress& progress) {
    const auto start = std::chrono::steady_clock::now();
    const ContentKey key = options_.cache ? prepared_key(*device_, geometry, plan) : ContentKey{};
    if (options_.cache) scene_ = find_prepared(*device_, *options_.cache, key, geometry, plan);
    if (scene_) return {};
    if (const std::uint64_t bytes = estimate_preparation(geometry, plan); bytes > device_->limits().heap)
      return bad_value("preparing " + std::to_string(geometry.mockup.triangles.size()) +
                       " triangles takes up to " + std::to_string(bytes >> 20) + " MiB, more than the " +
                       std::to_string(device_->limits().heap >> 20) + " MiB of memory of " + device_->name());
    // Preparation is large dispatches, for which lavapipe's own threads are worth their start; a frame's are
    // small.
    const auto wide = wide_device();
    auto scene = prepare_scene(wide ? *wide : *device_, geometry, plan, progress);
    if (!scene) return scene.error();
    if (wide) {
      auto shared = share_scene(*device_, *scene);
      if (!shared) return shared.error();
      scene_.emplace(std::move(*shared));
      scene = Error{};  // what the wide device has of it
    } else {
      scene_.emplace(std::move(*scene));
    }
    if (options_.cache)
      keep_prepared(*device_, *options_.cache, key, *scene_,
                    std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count());
    return {};
  }

  /// The same device with threads of its own, for preparation; null where it has none to offer or tests look
  /// on.
  std::unique_ptr<VulkanDevice> wide_device() const {
    if (!options_.inline_execution || !device_->shares_memory() || device_->guarded || options_.fault ||
        std::getenv("LP_NUM_THREADS") != nullptr)
      return nullptr;
    GpuOptions options = options_;
    options.inline_execution = false;
    auto made = VulkanDevice::create(options);
    return made && (*made)->name() == device_->name() && (*made)->shares_memory() ? std::move(*made)
                                                                                  : nullptr;
  }

  void set_helpers_up() {
    if (workers_ || no_workers_) return;
    no_workers_ = true;
    const bool own_devices = device_->shares_memory() && options_.inline_execution;
    const unsigned most = own_devices || scene_->constants.refined == 0 ? kMostHelpers : kMostGrids;
    auto made = BatchWorkers::create(options_, *device_, own_devices, *geometry_, *scene_, plan_, *frame_,
                                     std::min(processors() - 1, most));
    if (made) workers_ = std::move(*made);  // else one thread answers all, as before
  }

  std::unique_ptr<VulkanDevice> device_;
  GpuOptions options_;
  const SceneGeometry* geometry_ = nullptr;  ///< of scene_
  Plan plan_;                                ///< of frame_
  std::optional<PreparedScene> scene_;
  std::unique_ptr<Frame> frame_;
  std::unique_ptr<BatchWorkers> workers_;
  bool no_workers_ = false;  ///< setting them up was tried
  std::size_t shared_ = 0;   ///< pieces of all work so far
};

}  // namespace

Result<std::unique_ptr<CollisionBackend>> make_gpu_backend(const GpuOptions& options) {
  auto device = VulkanDevice::create(options);
  if (!device) return device.error();
  return std::unique_ptr<CollisionBackend>(std::make_unique<GpuBackend>(std::move(*device), options));
}

std::vector<VulkanDeviceInfo> list_vulkan_devices() { return VulkanDevice::list(); }

}  // namespace palpate

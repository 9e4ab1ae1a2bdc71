#include "compute/gpu_backend.h"

#include <chrono>
#include <optional>
#include <utility>

#include "compute/frame.h"
#include "compute/prepare_cache.h"
#include "compute/prepared_scene.h"
#include "compute/vulkan_device.h"

namespace palpate {
namespace {

/// The Vulkan back end: a device, the scene on it, and the frame that answers queries.
class GpuBackend final : public CollisionBackend {
 public:
  GpuBackend(std::unique_ptr<VulkanDevice> device, const GpuOptions& options)
      : device_(std::move(device)), first_capacity_(options.first_capacity), cache_(options.cache) {}

  Result<void> prepare(const SceneGeometry& geometry, const Plan& plan, const Progress& progress) override {
    frame_.reset();
    scene_.reset();
    if (auto found = scene_for(geometry, plan, progress); !found) return found;
    geometry_ = &geometry;
    return make_frame(plan);
  }

  Result<void> replan(const Plan& plan) override {
    if (!scene_ || (plan.profile == Profile::kRefined) != (scene_->constants.refined != 0))
      return Error{ErrorCode::kInternal, "no scene has been prepared for this plan's profile"};
    frame_.reset();   // two frames' lists may not fit
    return make_frame(plan);
  }

  Result<void> query(const LatticePose& pose, const Held* held, Contacts& out) override {
    if (!frame_) return Error{ErrorCode::kInternal, "query before prepare"};
    if (auto r = frame_->query(pose, held, out); !r) return r;
    return device_->check_guards();
  }

  Result<void> enlarge() override {
    if (!frame_) return Error{ErrorCode::kInternal, "enlarge before prepare"};
    return frame_->enlarge();
  }

  Result<VoxelPartition> partition(bool tool) const override {
    if (!scene_) return Error{ErrorCode::kInternal, "partition before prepare"};
    return read_partition(*device_, tool ? scene_->tool.partition : scene_->mockup.partition);
  }

  Result<std::vector<std::pair<std::uint32_t, std::uint32_t>>> pairs() const override {
    if (!frame_) return Error{ErrorCode::kInternal, "pairs before prepare"};
    return frame_->pairs();
  }

  bool has_internal_voxels() const override { return scene_ && scene_->mockup.partition.has_internal; }
  std::string name() const override { return "gpu"; }
  std::string device() const override { return device_->name(); }
  std::uint64_t memory_bytes() const override {
    return (scene_ ? scene_->memory_bytes() : 0) + (frame_ ? frame_->memory_bytes() : 0);
  }
  std::vector<StageMemory> memory_by_stage() const override {
    return frame_ ? frame_->memory_by_stage() : std::vector<StageMemory>{};
  }

 private:
  Result<void> make_frame(const Plan& plan) {
    auto frame = Frame::create(*device_, *geometry_, *scene_, first_capacity_, plan);
    if (!frame) return frame.error();
    frame_ = std::move(*frame);
    return device_->check_guards();
  }

  /// Fills scene_, from the cache if it is there.
  Result<void> scene_for(const SceneGeometry& geometry, const Plan& plan, const Progress& progress) {
    const auto start = std::chrono::steady_clock::now();
    const ContentKey key = cache_ ? prepared_key(*device_, geometry, plan) : ContentKey{};
    if (cache_) scene_ = find_prepared(*device_, *cache_, key);
    if (scene_) return {};
    auto scene = prepare_scene(*device_, geometry, plan, progress);
    if (!scene) return scene.error();
    scene_.emplace(std::move(*scene));
    if (cache_) keep_prepared(*device_, *cache_, key, *scene_, std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count());
    return {};
  }

  std::unique_ptr<VulkanDevice> device_;
  std::map<std::string, std::uint32_t> first_capacity_;
  std::shared_ptr<DiskCache> cache_;
  const SceneGeometry* geometry_ = nullptr;   ///< of scene_
  std::optional<PreparedScene> scene_;
  std::unique_ptr<Frame> frame_;
};

}  // namespace

Result<std::unique_ptr<CollisionBackend>> make_gpu_backend(const GpuOptions& options) {
  auto device = VulkanDevice::create(options);
  if (!device) return device.error();
  return std::unique_ptr<CollisionBackend>(std::make_unique<GpuBackend>(std::move(*device), options));
}

std::vector<VulkanDeviceInfo> list_vulkan_devices() { return VulkanDevice::list(); }

}  // namespace palpate

#pragma once
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "compute/gpu/frame/frame.h"
#include "compute/gpu/gpu_backend.h"
#include "compute/gpu/prepare/prepared_scene.h"
#include "compute/vulkan/device.h"
#include "compute/vulkan/pipeline.h"
#include "model/collision_backend.h"

namespace palpate::mutation {

/// The Vulkan back end with its shaders in reach: a module that pipelines have been made of can be swapped
/// for a mutant of it. Guards lie round every buffer; what is written there is an error. What has been
/// prepared of a geometry by the unchanged modules is kept, for mutants that run in frames only.
class MutableDevice final : public CollisionBackend {
 public:
  /// `as_gpu`: frames run as on a GPU with memory of its own. Throws std::runtime_error where there is no
  /// device.
  explicit MutableDevice(bool as_gpu);

  Result<void> prepare(const SceneGeometry& geometry, const Plan& plan, const Progress& progress) override;
  Result<void> query(const LatticePose& pose, const Ignored* ignored, Contacts& out) override;
  Result<VoxelPartition> partition(bool tool) const override;
  bool has_internal_voxels() const override { return scene().mockup.partition.has_internal; }
  std::string name() const override { return "gpu"; }
  std::string device() const override { return device_->name(); }
  std::uint64_t memory_bytes() const override { return 0; }

  /// From the next prepare() on every pipeline of the module `original`, SPIR-V, is one of `mutant`.
  /// `prepares`: preparation runs it, so that nothing kept will do. Error: the driver refuses it.
  Result<void> swap(const std::string& original, const std::string& mutant, bool prepares);
  /// From the next prepare() on, whether frames work the mock-up's samples out, as where there is no room for
  /// their list.
  void without_samples(bool without) { without_samples_ = without; }
  /// From the next prepare() on, items that these lists hold (GpuOptions::first_capacity); empty: enough.
  void first_capacity(const std::map<std::string, std::uint32_t>& items) { first_capacity_ = items; }
  VulkanDevice& device() { return *device_; }
  /// How many pipelines are swapped. 0: no case so far runs the module.
  std::size_t swapped() const { return swapped_.size(); }
  /// From the next prepare() on all is as it was.
  void restore();
  /// As restore(), until put_back(): that swaps pipelines that have been made meanwhile, too.
  void set_aside();
  Result<void> put_back();

 private:
  using Key = std::vector<std::uint32_t>;  // of VulkanDevice::pipelines
  using Words = std::vector<std::uint32_t>;

  Result<void> swap_all(const Words& before, const Words& after);

  /// What a geometry was prepared to.
  struct Prepared {
    PreparedScene scene;
    VoxelPartition mockup, tool;
    VulkanBuffer points;  // the scene's samples, while it goes without
  };
  /// Whether the kept scene has its samples, if it ever had.
  void list_samples(bool listed);
  Result<std::unique_ptr<Frame>> make_frame(const SceneGeometry& geometry);
  const PreparedScene& scene() const { return fresh_ ? *fresh_ : kept_of_->scene; }

  std::unique_ptr<VulkanDevice> device_;
  std::map<const SceneGeometry*, Prepared> kept_;
  Prepared* kept_of_ = nullptr;         // of the geometry prepared last, unless a mutant prepared it
  std::optional<PreparedScene> fresh_;  // by a mutant
  std::unique_ptr<Frame> frame_;
  std::vector<std::pair<Words, Words>> mutants_;  // modules before and after
  bool prepares_ = false, aside_ = false;         // a mutant does; all are set aside
  bool without_samples_ = false;
  std::map<std::string, std::uint32_t> first_capacity_;
  std::vector<std::pair<Key, std::shared_ptr<PendingPipeline>>> swapped_;  // what stood there
};

}  // namespace palpate::mutation

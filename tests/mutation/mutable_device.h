#pragma once
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "compute/frame.h"
#include "compute/prepared_scene.h"
#include "compute/vulkan_device.h"
#include "compute/vulkan_pipeline.h"
#include "model/collision_backend.h"

namespace palpate::mutation {

/// The Vulkan back end with its shaders in reach: a module that pipelines have been made of can be swapped for a mutant of it. Guards lie
/// round every buffer; what is written there is an error.
class MutableDevice final : public CollisionBackend {
 public:
  /// Throws std::runtime_error where there is no device.
  MutableDevice();

  Result<void> prepare(const SceneGeometry& geometry, const Plan& plan, const Progress& progress) override;
  Result<void> query(const LatticePose& pose, const Held* held, Contacts& out) override;
  Result<VoxelPartition> partition(bool tool) const override;
  bool has_internal_voxels() const override { return scene_->mockup.partition.has_internal; }
  std::string name() const override { return "gpu"; }
  std::string device() const override { return device_->name(); }
  std::uint64_t memory_bytes() const override { return 0; }

  /// From the next prepare() on every pipeline of the module `original`, SPIR-V, is one of `mutant`. Error: the driver refuses it;
  /// kUsage: there is no such pipeline.
  Result<void> swap(const std::string& original, const std::string& mutant);
  /// From the next prepare() on all is as it was.
  void restore();

 private:
  using Key = std::vector<std::uint32_t>;   // of VulkanDevice::pipelines

  std::unique_ptr<VulkanDevice> device_;
  std::optional<PreparedScene> scene_;
  std::unique_ptr<Frame> frame_;
  std::vector<std::pair<Key, std::shared_ptr<const PipelineObjects>>> swapped_;   // what stood there
};

}  // namespace palpate::mutation

#pragma once
#include <array>
#include <cstdint>
#include <functional>
#include <span>
#include <vector>

#include "compute/gpu/host_copy.h"
#include "compute/scene/samples.h"
#include "compute/gpu/prepare/prepared_scene.h"
#include "model/lattice_mesh.h"

namespace palpate {

/// Parts of preparation that the host does where the device is the host's own processor: what shaders/sample_list.comp asks
/// there lane by lane is a few instructions here, on all cores. The same samples bit for bit.
class HostPreparation {
 public:
  /// The mock-up's lists as preparation has made them; all outlive this. Allocates where buffers are not mapped.
  static Result<HostPreparation> make(VulkanDevice& device, const LatticeMesh& mesh, const PartitionBuffers& lists);

  enum class Outcome : std::uint8_t { kDone, kTooMany, kCancelled };
  /// Whether to go on, asked now and then on the calling thread; `done` is a share from 0 to 1.
  using GoOn = std::function<bool(double done)>;

  /// Every entry's samples. kTooMany: more than `most_bytes`, or than EntrySamples can number.
  Outcome list_samples(std::int32_t spacing, std::uint64_t most_bytes, const GoOn& go_on, EntrySamples& out) const;

  /// Voxel by voxel what either this or the shaders have listed entry by entry. kTooMany: a voxel lists more than HostSamples::kLongestList. What is not
  /// done leaves `out` half written.
  Outcome list_points(std::int32_t spacing, const GoOn& go_on, EntrySamples from, HostSamples& out) const;

 private:
  /// Voxels [begins[i], begins[i + 1]) have about `entries` entries.
  std::vector<std::uint32_t> shares_of(std::uint32_t entries) const;
  Int3 low_of(std::uint32_t boundary) const;
  void sample_voxel(std::uint32_t boundary, std::int32_t spacing, std::uint64_t most_words, std::uint32_t* begin, std::vector<std::uint32_t>& words, bool wide) const;

  const LatticeMesh* mesh_ = nullptr;
  gpu::GridConstants grid_{};
  HostCopy<std::uint32_t> list_begin_, list_triangles_, boundary_place_, mixed_brick_;
};

}  // namespace palpate

#pragma once
#include <array>
#include <cstdint>
#include <functional>
#include <span>
#include <vector>

#include "compute/host_copy.h"
#include "compute/host_samples.h"
#include "compute/prepared_scene.h"
#include "model/lattice_mesh.h"

namespace palpate {

/// Parts of preparation that the host does where the device is the host's own processor: what shaders/sample_list.comp and seam_find.comp ask
/// there lane by lane is a few instructions here, on all cores. The same samples bit for bit; candidates of seams are others, and what is
/// found among them the same.
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

  using Pair = std::array<std::uint32_t, 2>;
  /// Pairs of triangles that may touch along a seam under a smooth angle, the smaller id first, in no order; a pair may come several times.
  /// `least_cosine` is of unit normals in Q30, Q60. A run is some voxels; `take` gets each on the calling thread and says whether to go on.
  /// kTooMany: so many triangles lie in some voxels that the pairs of a run pass 128 MiB.
  Outcome find_seams(std::int64_t least_cosine, const std::function<bool(std::span<const Pair> candidates, double done)>& take) const;

 private:
  struct Search;   // what a thread needs for seams
  /// Voxels [begins[i], begins[i + 1]) have about `entries` entries.
  std::vector<std::uint32_t> shares_of(std::uint32_t entries) const;
  Int3 low_of(std::uint32_t boundary) const;
  void seams_of(std::uint32_t boundary, std::int64_t least_cosine, Search& search) const;
  void sample_voxel(std::uint32_t boundary, std::int32_t spacing, std::uint64_t most_words, std::uint32_t* begin, std::vector<std::uint32_t>& words, bool wide) const;

  const LatticeMesh* mesh_ = nullptr;
  gpu::GridConstants grid_{};
  HostCopy<std::uint32_t> list_begin_, list_triangles_, boundary_place_, mixed_brick_;
};

}  // namespace palpate

#pragma once
#include <cstdint>
#include <vector>

namespace palpate {

/// Samples and first corners of the mock-up's triangles, entry by entry of its voxels' lists (a triangle in a voxel): they do not depend on the
/// pose, and only the host reads them. A sample is its place in the voxel's grid of samples, two numbers below 64, and its height
/// above the voxel's low side along the triangle's sample axis.
struct HostSamples {
  /// Begin of an entry's samples in its low bits, then whether the triangle's first corner lies in the voxel (which comes before the samples and
  /// is none of them), then the triangle's sample axis. One more at the end.
  std::vector<std::uint32_t> begin;
  /// Narrow: a word a sample, height | u << 20 | v << 26. Wide, for voxels of more than 2^20 steps: the height, then u | v << 6.
  std::vector<std::uint32_t> words;
  bool wide = false;

  static constexpr std::uint32_t kCorner = 1u << 29, kBegin = kCorner - 1;
  static constexpr int kAxisShift = 30;
  static constexpr std::int32_t kNarrowVoxel = 1 << 20;   ///< steps: the largest that a height of 20 bits is enough for

  std::uint64_t count() const { return words.size() / (wide ? 2 : 1); }
  bool listed() const { return !begin.empty(); }
  std::uint64_t bytes() const { return 4 * (std::uint64_t{begin.size()} + words.size()); }
};

}  // namespace palpate

#pragma once
#include <cstdint>
#include <vector>

#include "model/vector.h"

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
  /// All of them again, for a first look at many: which of the voxel's 1024ths along x, y and z (ten bits each, x lowest) a point lies in. A boundary
  /// voxel's points follow each other entry by entry, a first corner before the entry's samples. kPointsAtOnce - 1 more at the end say nothing.
  std::vector<std::uint32_t> points;
  std::vector<std::uint32_t> point_begin;   ///< by boundary voxel, and one more

  static constexpr std::uint32_t kCorner = 1u << 29, kBegin = kCorner - 1;
  static constexpr int kAxisShift = 30;
  static constexpr int kPointBits = 10;
  static constexpr std::size_t kPointsAtOnce = 8;   ///< may be read from any place on
  static constexpr std::int32_t kNarrowVoxel = 1 << 20;   ///< steps: the largest that a height of 20 bits is enough for

  std::uint64_t count() const { return words.size() / (wide ? 2 : 1); }
  bool listed() const { return !begin.empty(); }
  std::uint64_t bytes() const { return 4 * (std::uint64_t{begin.size()} + words.size() + points.size() + point_begin.size()); }
  /// Of entry `e`.
  bool has_corner(std::size_t e) const { return (begin[e] & kCorner) != 0; }
  std::uint32_t samples_of(std::size_t e) const { return (begin[e + 1] & kBegin) - (begin[e] & kBegin); }

  /// A voxel's samples as lattice points. Steps.
  struct Voxel {
    Int3 low;    ///< its lowest lattice point
    Int3 grid;   ///< its first grid point, axis by axis
    std::int32_t spacing;
    Voxel(const Int3& lowest, std::int32_t sample_spacing) : low(lowest), spacing(sample_spacing) {
      for (int k = 0; k < 3; ++k) {
        const std::int32_t q = low[k] / spacing;
        grid[k] = spacing * (q + (q * spacing < low[k] ? 1 : 0));
      }
    }
  };
  /// Sample `i` of entry `e`, counted from the entry's first.
  Int3 sample(const Voxel& voxel, std::size_t e, std::uint32_t i) const {
    const std::size_t number = (begin[e] & kBegin) + i;
    const std::uint32_t* at = &words[wide ? 2 * number : number];
    const std::uint32_t height = wide ? at[0] : at[0] & 0xFFFFF, place = wide ? at[1] : at[0] >> 20;
    const int axis = static_cast<int>(begin[e] >> kAxisShift), u = axis == 2 ? 0 : axis + 1, v = axis == 0 ? 2 : axis - 1;
    Int3 out;
    out[axis] = voxel.low[axis] + static_cast<std::int32_t>(height);
    out[u] = voxel.grid[u] + voxel.spacing * static_cast<std::int32_t>(place & 63);
    out[v] = voxel.grid[v] + voxel.spacing * static_cast<std::int32_t>(place >> 6);
    return out;
  }
};

}  // namespace palpate

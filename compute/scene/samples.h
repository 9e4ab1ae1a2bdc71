#pragma once
#include <cstdint>
#include <vector>

#include "model/lattice/sample_grid.h"
#include "model/lattice/vector.h"
#include "shaders/shared/prepare.h"

namespace palpate {

/// Samples and first corners of the mock-up's triangles, voxel by voxel: they do not depend on the pose, and
/// only the host reads them. A sample is the place of its cell among those that reach into the voxel, two
/// numbers below 64, and its height above the voxel's low side along its triangle's sample axis.
struct VoxelSamples {
  struct Begin {
    std::uint32_t point, sample, owner;  ///< numbers of the voxel's first ones
    bool operator==(const Begin&) const = default;
  };
  std::vector<Begin> begin;  ///< by boundary voxel, and one more

  /// A voxel's points: vertices that are first corners, each once, by their numbers in the mesh; then samples
  /// in the order of the voxel's list. Which of the voxel's 1024ths along x, y and z a point lies in (ten
  /// bits each, x lowest), and above that a sample's axis, 0 for a corner. kPointsAtOnce - 1 more at the end
  /// say nothing.
  std::vector<std::uint32_t> points;
  /// Of each point, for a sample: which entry of the voxel's list is its triangle's; for a corner: which of
  /// the voxel's `owners` is its first. The next corner's end them, and after the last corner the voxel's.
  std::vector<std::uint16_t> entries;
  std::vector<std::uint16_t> owners;  ///< corner by corner the entries of the triangles that begin there
  /// By sample. Narrow: a word, height | u << 20 | v << 26. Wide, for voxels of more than kNarrowVoxel steps:
  /// the height, then u | v << 6.
  std::vector<std::uint32_t> words;
  bool wide = false;

  static constexpr int kPointBits = 10;
  static constexpr int kAxisShift = 3 * kPointBits;
  static constexpr std::size_t kPointsAtOnce = 8;  ///< may be read from any place on
  static constexpr std::uint32_t kLongestList =
      1u << 16;  ///< entries of a voxel that can be told apart: with longer ones nothing is listed
  static constexpr std::int32_t kNarrowVoxel =
      1 << 20;  ///< steps: the largest that a height of 20 bits is enough for

  bool operator==(const VoxelSamples&) const = default;
  std::uint64_t count() const { return words.size() / (wide ? 2 : 1); }
  bool listed() const { return !begin.empty(); }
  std::uint64_t bytes() const {
    return sizeof(Begin) * begin.size() + 4 * std::uint64_t{points.size()} +
           2 * std::uint64_t{entries.size()} + 2 * std::uint64_t{owners.size()} +
           4 * std::uint64_t{words.size()};
  }

  /// A voxel's samples as lattice points. Steps.
  struct Voxel {
    Int3 low;    ///< its lowest lattice point
    Int3 first;  ///< the first cell of samples that reaches into it, axis by axis
    SampleGrid grid;
    Voxel(const Int3& lowest, std::int32_t spacing) : low(lowest), grid{spacing} {
      for (int k = 0; k < 3; ++k) first[k] = static_cast<std::int32_t>(grid.cell(low[k]));
    }
  };
  /// Sample `number` along `axis` of all voxels' samples.
  Int3 sample(const Voxel& voxel, int axis, std::size_t number) const {
    const std::uint32_t* at = &words[wide ? 2 * number : number];
    const std::uint32_t height = wide ? at[0] : at[0] & 0xFFFFF, place = wide ? at[1] : at[0] >> 20;
    const int u = axis == 2 ? 0 : axis + 1, v = axis == 0 ? 2 : axis - 1;
    const std::int32_t i = voxel.first[u] + static_cast<std::int32_t>(place & 63),
                       j = voxel.first[v] + static_cast<std::int32_t>(place >> 6),
                       along = voxel.low[axis] + static_cast<std::int32_t>(height),
                       at_u = static_cast<std::int32_t>(voxel.grid.u(i, j)),
                       at_v = static_cast<std::int32_t>(voxel.grid.v(i, j));
    // Not component by component: what is written so must go through memory before it can be read as a whole.
    return axis == 0   ? Int3(along, at_u, at_v)
           : axis == 1 ? Int3(at_v, along, at_u)
                       : Int3(at_u, at_v, along);
  }
};

/// The same while it is prepared, entry by entry of the voxels' lists (a triangle in a voxel).
struct EntrySamples {
  /// Begin of an entry's samples in its low bits, then whether the triangle's first corner lies in the voxel
  /// (gpu::kSampleCorner), then the triangle's sample axis (gpu::kSampleAxisShift). One more at the end.
  std::vector<std::uint32_t> begin;
  std::vector<std::uint32_t> words;  ///< as VoxelSamples::words
  bool wide = false;

  static constexpr std::uint32_t kBegin = gpu::kSampleCorner - 1;

  /// Of entry `e`: first() is the number of its first sample, and of the next one's the end.
  bool has_corner(std::size_t e) const { return (begin[e] & gpu::kSampleCorner) != 0; }
  int axis(std::size_t e) const { return static_cast<int>(begin[e] >> gpu::kSampleAxisShift); }
  std::uint32_t first(std::size_t e) const { return begin[e] & kBegin; }
};

}  // namespace palpate

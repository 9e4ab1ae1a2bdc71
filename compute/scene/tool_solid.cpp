#include "compute/scene/tool_solid.h"

#include <algorithm>
#include <cmath>

#include "compute/scene/partition_lookup.h"

namespace palpate {
namespace {

constexpr std::int32_t kFiner =
    4;  // a fine voxel's side is that part of a voxel's (chosen: a sample's spacing)
constexpr std::uint64_t kMostFineVoxels = 4'000'000;  // boundary voxels, estimated (chosen: memory)
constexpr std::uint64_t kMostFineBricks = 8'000'000;
constexpr std::int32_t kMostFineRadius =
    1 << 27;  // steps: up to it, rotations keep lengths to 0.3 steps (lib/tool_walk.glsl)
constexpr std::uint64_t kMostNearVoxels = std::uint64_t{1} << 29;

/// The axis step that leads out of the solid through the fewest boundary voxels; every straight line leads
/// out.
std::uint32_t way_out(const PartitionLookup& classes, const Int3& from) {
  std::uint32_t best = 0;
  int fewest = INT32_MAX;
  for (std::uint32_t step = 0; step < 6; ++step) {
    Int3 at = from;
    int crossed = 0;
    for (std::uint32_t c = gpu::kVoxelBoundary; c != gpu::kVoxelExternal && crossed < fewest;
         c = classes.at(at).kind) {
      if (c == gpu::kVoxelBoundary) crossed += 8;
      crossed += 1;
      at[static_cast<int>(step / 2)] += step % 2 == 0 ? -1 : 1;
    }
    if (crossed >= fewest) continue;
    fewest = crossed;
    best = step;
  }
  return best;
}

}  // namespace

std::int32_t fine_voxel_size(const SceneGeometry& geometry, const gpu::GridConstants& own) {
  const std::int32_t size = own.size / kFiner & ~1;
  const std::uint64_t more = std::uint64_t{kFiner} * kFiner;
  const bool worth = geometry.tool.closed && size >= 8 && geometry.tool_radius <= kMostFineRadius &&
                     own.boundary_voxels * more <= kMostFineVoxels &&
                     brick_count(own.bricks) * more * kFiner <= kMostFineBricks;
  return worth ? size : 0;
}

std::vector<std::uint32_t> ways_out(const PartitionView& p) {
  const PartitionLookup classes(p);
  std::vector<std::uint32_t> exits(p.grid.boundary_voxels);
  for (std::uint32_t boundary = 0; boundary < exits.size(); ++boundary)
    exits[boundary] = way_out(classes, p.boundary_voxel(boundary));
  return exits;
}

SolidCubes::SolidCubes(const Int3& cubes, double side) : n_(cubes), side_(side), words_((cubes.x + 63) / 64) {
  rows_.resize(static_cast<std::size_t>(words_) * static_cast<std::size_t>(n_.y) *
               static_cast<std::size_t>(n_.z));
}

std::vector<std::uint32_t> SolidCubes::near(double distance) const {
  const auto words = static_cast<std::size_t>(words_);
  // Two cubes whose index differs by d have points (|d| − 1)+ cubes apart an axis.
  const double reach = distance / side_;
  const int most = static_cast<int>(reach) + 1;
  const auto gap = [](int d) {
    const double g = std::max(std::abs(d) - 1, 0);
    return g * g;
  };
  std::vector<std::uint64_t> out(rows_.size());
  std::vector<std::uint64_t> wide(words * static_cast<std::size_t>(most + 2));  // a row, ever wider
  for (int z = 0; z < n_.z; ++z)
    for (int y = 0; y < n_.y; ++y) {
      const std::uint64_t* row = &rows_[place(0, y, z)];
      if (std::all_of(row, row + words, [](std::uint64_t word) { return word == 0; })) continue;
      std::copy_n(row, words, wide.begin());
      for (std::size_t w = 1; w < static_cast<std::size_t>(most + 2); ++w)
        for (std::size_t i = 0; i < words; ++i) {
          const std::uint64_t* before = &wide[(w - 1) * words];
          wide[w * words + i] = before[i] | before[i] << 1 | before[i] >> 1 |
                                (i > 0 ? before[i - 1] >> 63 : 0) | (i + 1 < words ? before[i + 1] << 63 : 0);
        }
      for (int to_z = std::max(z - most, 0); to_z <= std::min(z + most, n_.z - 1); ++to_z)
        for (int to_y = std::max(y - most, 0); to_y <= std::min(y + most, n_.y - 1); ++to_y) {
          const double left = reach * reach - gap(to_z - z) - gap(to_y - y);
          if (left < 0) continue;
          const std::uint64_t* from = &wide[static_cast<std::size_t>(std::sqrt(left) + 1) * words];
          std::uint64_t* to = &out[place(0, to_y, to_z)];
          for (std::size_t i = 0; i < words; ++i) to[i] |= from[i];
        }
    }
  // Rows of whole bytes, one behind the other.
  const auto row_bytes = static_cast<std::size_t>(n_.x / 8);
  std::vector<std::uint32_t> bits(
      (row_bytes * static_cast<std::size_t>(n_.y) * static_cast<std::size_t>(n_.z) + 3) / 4);
  std::size_t byte = 0;
  for (std::size_t row = 0; row < out.size(); row += words)
    for (std::size_t i = 0; i < row_bytes; ++i, ++byte)
      bits[byte / 4] |= static_cast<std::uint32_t>(out[row + i / 8] >> 8 * (i % 8) & 0xFF) << 8 * (byte % 4);
  return bits;
}

std::vector<std::uint32_t> near_tool(const PartitionView& p, std::int32_t voxel_size) {
  const Int3 n = p.grid.bricks * 8;
  if (brick_count(p.grid.bricks) * 512 > kMostNearVoxels) return {};
  const PartitionLookup classes(p);
  SolidCubes solid(n, p.grid.size);
  for (int z = 0; z < n.z; ++z)
    for (int y = 0; y < n.y; ++y)
      for (int x = 0; x < n.x; ++x)
        if (classes.at({x, y, z}).kind != gpu::kVoxelExternal) solid.add(x, y, z);
  return solid.near(near_distance(voxel_size));
}

}  // namespace palpate

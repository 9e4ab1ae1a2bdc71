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
std::uint32_t way_out(const HostPartition& classes, const Int3& from) {
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
  const HostPartition classes(p);
  std::vector<std::uint32_t> exits(p.grid.boundary_voxels);
  for (std::uint32_t boundary = 0; boundary < exits.size(); ++boundary)
    exits[boundary] = way_out(classes, p.boundary_voxel(boundary));
  return exits;
}

std::vector<std::uint32_t> near_tool(const PartitionView& p, std::int32_t voxel_size) {
  const Int3 n = p.grid.bricks * 8;
  const std::uint64_t voxels = brick_count(p.grid.bricks) * 512;
  if (voxels > kMostNearVoxels) return {};
  const HostPartition classes(p);
  std::vector<std::uint8_t> near(voxels);
  std::size_t i = 0;
  for (int z = 0; z < n.z; ++z)
    for (int y = 0; y < n.y; ++y)
      for (int x = 0; x < n.x; ++x) near[i++] = classes.at({x, y, z}).kind != gpu::kVoxelExternal;

  // Two voxels whose index differs by d have points (|d| − 1)+ voxels apart an axis; rounding adds two steps.
  const double reach = (std::sqrt(0.75) * voxel_size + 4) / p.grid.size;
  const int most = static_cast<int>(reach) + 1;
  const auto gap = [](int d) {
    const double g = std::max(std::abs(d) - 1, 0);
    return g * g;
  };
  for (std::uint32_t boundary = 0; boundary < p.grid.boundary_voxels; ++boundary) {
    const Int3 v = p.boundary_voxel(boundary);
    for (int z = std::max(v.z - most, 0); z <= std::min(v.z + most, n.z - 1); ++z)
      for (int y = std::max(v.y - most, 0); y <= std::min(v.y + most, n.y - 1); ++y) {
        const double left = reach * reach - gap(z - v.z) - gap(y - v.y);
        if (left < 0) continue;
        const int wide = static_cast<int>(std::sqrt(left)) + 1;
        const std::size_t row =
            static_cast<std::size_t>(n.x) *
            (static_cast<std::size_t>(y) + static_cast<std::size_t>(n.y) * static_cast<std::size_t>(z));
        const int first = std::max(v.x - wide, 0), last = std::min(v.x + wide, n.x - 1);
        std::fill(near.begin() + static_cast<std::ptrdiff_t>(row) + first,
                  near.begin() + static_cast<std::ptrdiff_t>(row) + last + 1, std::uint8_t{1});
      }
  }
  std::vector<std::uint32_t> bits(voxels / 32);
  for (i = 0; i < voxels; ++i) bits[i / 32] |= std::uint32_t{near[i]} << (i % 32);
  return bits;
}

}  // namespace palpate

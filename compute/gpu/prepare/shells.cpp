// How many shells of an open body the middles of its boundary voxels are in: the least that six walks along
// the axes say, of the near ones if there are any (docs/EXACTNESS.md section 4, "Vote"). A walk crosses what
// each voxel on its way is crossed by, so one sweep along a row knows what all walks from its voxels say.
// Then neighbours are asked what they say of each other.
#include <array>
#include <cstdint>

#include "compute/gpu/prepare/partition.h"
#include "shaders/code.h"
#include "shaders/shared/prepare.h"

namespace palpate {

constexpr std::uint64_t kVoxelsAnInside = 8;  // of them one at least is in a shell, …
constexpr std::uint64_t kVoxelsADoubt = 16;   // … or one at most in doubt, of what bounds an inside

bool count_shells(PrepareSteps& steps, const VoxelPairs& pairs, BodyBuffers& body) {
  PartitionBuffers& p = body.partition;
  const std::uint64_t voxels = p.grid.boundary_voxels;
  std::array<VulkanBuffer, 3> halves_along;
  for (VulkanBuffer& halves : halves_along) halves = steps.buffer("crossings of half voxels", voxels, 8);
  const VulkanBuffer link = steps.buffer("rows of bricks", p.grid.mixed_bricks);
  p.shells = steps.buffer("shells of voxels", voxels, 12);
  const VulkanBuffer counts = steps.buffer("voxels inside and in doubt", 2);
  if (!steps.ok()) return false;
  steps.fill(p.shells, INT32_MAX);
  gpu::GridPush push;
  push.origin = p.grid.origin;
  push.size = p.grid.size;
  push.bricks = p.grid.bricks;
  for (std::uint32_t axis = 0; axis < 3; ++axis) {
    const int u = static_cast<int>((axis + 1) % 3), v = static_cast<int>((axis + 2) % 3);
    const std::uint64_t rows =
        static_cast<std::uint64_t>(p.grid.bricks[u]) * static_cast<std::uint64_t>(p.grid.bricks[v]);
    const VulkanBuffer head = steps.buffer("rows of bricks", rows);
    if (!steps.ok()) return false;
    const VulkanBuffer& halves = halves_along[axis];
    push.axis = axis;
    push.count = pairs.count;
    steps.fill(halves, 0);
    steps.run_items(spirv::half_cross, {},
                    {body.vertices, body.triangles, body.triangle_info, pairs.triangle, pairs.voxel,
                     p.boundary_place, p.mixed_brick, halves},
                    push, pairs.count);
    for (const std::uint32_t up : {0u, 1u}) {
      push.count = static_cast<std::uint32_t>(rows);
      steps.run_items(spirv::row_link, {1 - up}, {p.brick_slot, head, link}, push, rows);
      push.count = static_cast<std::uint32_t>(rows * 64);
      const std::uint32_t last = axis == 2 && up == 1 ? 1 : 0;
      steps.run_items(spirv::shell_sweep, {up, last},
                      {p.brick_slot, p.mixed_brick, p.bricks, halves, head, link, p.shells}, push, rows * 64);
    }
    steps.progress("shells", 0.95);
  }
  push.count = static_cast<std::uint32_t>(voxels);
  const auto& [x, y, z] = halves_along;
  steps.fill(counts, 0);
  steps.run_items(spirv::shell_doubt, {},
                  {p.brick_slot, p.mixed_brick, p.bricks, p.boundary_place, x, y, z, p.shells, counts}, push,
                  voxels);
  const std::uint64_t inside = steps.read(counts, 0), doubted = steps.read(counts, 1);
  return kVoxelsAnInside * inside >= voxels || kVoxelsADoubt * doubted <= voxels;
}

}  // namespace palpate

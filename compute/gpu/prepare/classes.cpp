// Classes of the voxels that are not boundary: components inside bricks, joined across bricks; votes by the
// winding of voxel centres, swept along rows.
#include <cstdint>

#include "compute/gpu/prepare/partition.h"
#include "shaders/code.h"
#include "shaders/shared/prepare.h"

namespace palpate {

void classify(PrepareSteps& steps, const LatticeMesh& mesh, const VoxelPairs& pairs, BodyBuffers& body) {
  PartitionBuffers& p = body.partition;
  const std::uint32_t slots = p.grid.mixed_bricks;
  const auto bricks = static_cast<std::uint32_t>(static_cast<std::uint64_t>(p.grid.bricks.x) *
                                                 static_cast<std::uint64_t>(p.grid.bricks.y) *
                                                 static_cast<std::uint64_t>(p.grid.bricks.z));
  gpu::GridPush grid{};
  grid.origin = p.grid.origin;
  grid.size = p.grid.size;
  grid.bricks = p.grid.bricks;

  // Components of each mixed brick.
  VulkanBuffer labels = steps.buffer("components of voxels", std::uint64_t{slots} * 128);
  VulkanBuffer first = steps.buffer("components of bricks", std::uint64_t{slots} + 1);
  if (!steps.ok()) return;
  steps.fill(labels, 0);
  steps.run_items(spirv::brick_label, {}, {p.bricks, labels, first}, slots, slots);
  const std::uint64_t nodes = 1 + std::uint64_t{bricks} + steps.scan("components", first, slots);
  steps.progress("components", 0.75);

  // Joined across the bricks' faces, again until no invocation gave up.
  VulkanBuffer parent = steps.buffer("parents of components", nodes);
  const VulkanBuffer again = steps.buffer("again", 1);
  if (!steps.ok()) return;
  const auto node_count = static_cast<std::uint32_t>(nodes);
  steps.run_items(spirv::component_root, {1u}, {parent, again}, node_count, nodes);
  grid.count = bricks / static_cast<std::uint32_t>(p.grid.bricks.x);
  steps.run_items(spirv::row_init, {}, {p.brick_slot, parent}, grid, grid.count);
  grid.count = bricks * 3;
  int runs = 0;
  do {
    steps.fill(again, 0);
    steps.run_items(spirv::component_join, {}, {p.brick_slot, p.bricks, first, labels, parent, again}, grid,
                    grid.count);
    steps.run_items(spirv::component_root, {0u}, {parent, again}, node_count, nodes);
    if (++runs > 1000)
      steps.fail(Error{ErrorCode::kInternal, "the components of the voxels did not settle in 1000 runs"});
    steps.progress("components", 0.8);
  } while (steps.read(again, 0) != 0);

  // Votes along +x, and +y and +z where the mesh is open: there the winding depends on the direction.
  const std::uint32_t axes = mesh.closed ? 1 : 3;
  VulkanBuffer votes = steps.buffer("votes of components", nodes, 8);
  const VulkanBuffer enclosed = steps.buffer("bricks with enclosed voxels", slots);
  const VulkanBuffer link = steps.buffer("rows of bricks", slots);
  VulkanBuffer crossings = steps.buffer("crossings of rows", std::uint64_t{p.grid.boundary_voxels} * axes);
  if (!steps.ok()) return;
  steps.fill(votes, 0);
  steps.fill(crossings, 0);
  struct {
    gpu::GridPush grid;
    std::uint32_t voxels;
  } push{grid, p.grid.boundary_voxels};
  push.grid.count = pairs.count;
  push.grid.axis = axes;
  steps.run_items(spirv::row_cross, {},
                  {body.vertices, body.triangles, pairs.triangle, pairs.voxel, p.boundary_place,
                   p.mixed_brick, crossings},
                  push, pairs.count);
  steps.run_items(spirv::brick_enclosed, {}, {first, parent, enclosed}, gpu::EnclosedPush{slots, bricks},
                  slots);
  for (std::uint32_t axis = 0; axis < axes; ++axis) {
    const int u = static_cast<int>((axis + 1) % 3), v = static_cast<int>((axis + 2) % 3);
    const std::uint64_t rows =
        static_cast<std::uint64_t>(p.grid.bricks[u]) * static_cast<std::uint64_t>(p.grid.bricks[v]);
    const VulkanBuffer head = steps.buffer("rows of bricks", rows);
    if (!steps.ok()) return;
    push.grid.count = static_cast<std::uint32_t>(rows);
    push.grid.axis = axis;
    steps.run_items(spirv::row_link, {0u}, {p.brick_slot, head, link}, push.grid, rows);
    push.grid.count = static_cast<std::uint32_t>(rows * 64);
    push.voxels = p.grid.boundary_voxels * axis;  // first crossing of this axis
    steps.progress("votes", 0.85 + 0.05 * axis);
    steps.run_items(spirv::vote_sweep, {},
                    {p.mixed_brick, p.bricks, first, labels, parent, crossings, votes, head, link, enclosed},
                    push, rows * 64);
  }

  // Classes.
  const VulkanBuffer has_internal = steps.buffer("has internal voxels", 1);
  if (!steps.ok()) return;
  steps.fill(has_internal, 0);
  steps.run_items(spirv::brick_classify, {},
                  {p.brick_slot, p.bricks, first, labels, parent, votes, has_internal}, bricks, bricks);
  p.has_internal = steps.read(has_internal, 0) != 0;
}

}  // namespace palpate

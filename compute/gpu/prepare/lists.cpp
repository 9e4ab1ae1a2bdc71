// Boundary voxels and their triangles: triangle → groups of bricks → bricks → voxels, each level by count,
// scan, emit.
#include <algorithm>
#include <string>
#include <utility>
#include <vector>

#include "compute/gpu/prepare/partition.h"
#include "model/lattice/voxel_size.h"
#include "shaders/code.h"
#include "shaders/shared/frame.h"
#include "shaders/shared/prepare.h"

namespace palpate {
namespace {

/// Items (triangle, cell) of one level.
struct Items {
  VulkanBuffer triangle;
  VulkanBuffer cell;
  std::uint32_t count = 0;
};

class ListBuilder {
 public:
  ListBuilder(PrepareSteps& steps, const LatticeMesh& mesh, const VoxelGrid& grid, std::int32_t growth,
              const char* name, BodyBuffers& body)
      : steps_(steps), mesh_(mesh), grid_(grid), growth_(growth), name_(name), body_(body) {}

  VoxelPairs build();

 private:
  void check_grid();
  Items expand(std::uint32_t source, const Items& from, Int3 cells, Int3 parents, std::int32_t side,
               std::uint32_t count);
  Items large_triangles();
  void mark_bricks(const Items* lists, std::size_t count);
  VoxelPairs list_pairs(const Items* lists, std::size_t count);
  void scatter(VoxelPairs& pairs);
  std::uint64_t brick_count() const {
    return static_cast<std::uint64_t>(grid_.bricks.x) * static_cast<std::uint64_t>(grid_.bricks.y) *
           static_cast<std::uint64_t>(grid_.bricks.z);
  }

  PrepareSteps& steps_;
  const LatticeMesh& mesh_;
  const VoxelGrid& grid_;
  std::int32_t growth_;
  std::string name_;
  BodyBuffers& body_;
};

static_assert(gpu::kMostBricksAlong >= kMaxAutoBricksAlong, "an `auto` voxel must be usable here");

void ListBuilder::check_grid() {
  const Int3 b = grid_.bricks;
  const int most = std::max({b.x, b.y, b.z});
  if (most > gpu::kMostBricksAlong)
    steps_.fail(bad_value("the " + name_ + "'s grid has " + std::to_string(std::int64_t{most} * kBrickSide) +
                          " voxels along an axis, at most " +
                          std::to_string(gpu::kMostBricksAlong * kBrickSide) +
                          " are possible: choose a larger voxel"));
  // Before the many small steps, the dense table of bricks and their nodes (8 bytes of votes each) must fit.
  const std::uint64_t range = steps_.device().limits().storage_range;
  if (steps_.ok() && brick_count() > range / 8 - 2)
    steps_.fail(bad_value("the " + name_ + "'s grid has " + std::to_string(brick_count()) +
                          " bricks of 512 voxels, at most " + std::to_string(range / 8 - 2) +
                          " fit a buffer of " + steps_.device().name() + ": choose a larger voxel"));
}

/// Finds the cells of one level; `count` items or triangles come in. An empty list when nothing is found.
Items ListBuilder::expand(std::uint32_t source, const Items& from, Int3 cells, Int3 parents,
                          std::int32_t side, std::uint32_t count) {
  Items out;
  gpu::ExpandPush push{};
  push.origin = grid_.origin;
  push.side = side;
  push.cells = cells;
  push.growth = growth_;
  push.parents = parents;
  push.count = count;
  push.bricks = grid_.bricks;
  push.brick_side = grid_.size * kBrickSide;
  push.source = source;
  const bool items = source == gpu::kSourceItems;
  const VulkanBuffer& in_triangle = items ? from.triangle : body_.triangle_info;  // not read for triangles
  const VulkanBuffer& in_cell = items ? from.cell : body_.triangle_info;
  VulkanBuffer counts = steps_.buffer("counts of bricks", std::uint64_t{count} + 1);
  const VulkanBuffer unused = steps_.buffer("unused", 1);
  if (!steps_.ok()) return out;
  steps_.run_items(
      spirv::triangle_expand, {},
      {body_.vertices, body_.triangles, body_.triangle_info, in_triangle, in_cell, counts, unused, unused},
      push, count);
  out.count = steps_.scan("pairs of triangle and brick", counts, count);
  if (out.count == 0) return out;
  out.triangle = steps_.buffer("pairs of triangle and brick", out.count);
  out.cell = steps_.buffer("pairs of triangle and brick", out.count);
  if (!steps_.ok()) return out;
  push.emit = 1;
  steps_.run_items(spirv::triangle_expand, {},
                   {body_.vertices, body_.triangles, body_.triangle_info, in_triangle, in_cell, counts,
                    out.triangle, out.cell},
                   push, count);
  return out;
}

/// Triangles whose box holds many bricks go down a hierarchy of cells, an eighth of the side a level.
Items ListBuilder::large_triangles() {
  std::vector<Int3> cells{grid_.bricks};
  std::vector<std::int32_t> sides{grid_.size * kBrickSide};
  while (std::max({cells.back().x, cells.back().y, cells.back().z}) > gpu::kTopCells) {
    cells.push_back((cells.back() + 7) / 8);
    sides.push_back(sides.back() * 8);  // below eight times the grid's extent, 2^29, over eight cells
  }
  std::size_t level = cells.size() - 1;
  Items items = expand(gpu::kSourceLarge, {}, cells[level], Int3(0), sides[level],
                       static_cast<std::uint32_t>(mesh_.triangles.size()));
  while (level > 0 && items.count > 0 && steps_.ok()) {
    --level;
    items = expand(gpu::kSourceItems, items, cells[level], cells[level + 1], sides[level], items.count);
  }
  return items;
}

/// Gives every touched brick a slot, in ascending order of brick numbers.
void ListBuilder::mark_bricks(const Items* lists, std::size_t count) {
  PartitionBuffers& p = body_.partition;
  VulkanBuffer marks = steps_.buffer("brick marks", brick_count() + 1);
  p.brick_slot = steps_.buffer("brick table", brick_count());
  if (!steps_.ok()) return;
  steps_.fill(marks, 0);
  for (std::size_t i = 0; i < count; ++i)
    if (lists[i].count > 0)
      steps_.run_items(spirv::brick_mark, {}, {lists[i].cell, marks}, lists[i].count, lists[i].count);
  p.grid.mixed_bricks = steps_.scan("bricks", marks, brick_count());
  if (p.grid.mixed_bricks >= gpu::kMostMixedBricks)
    steps_.fail(bad_value("the " + name_ + "'s surface lies in " + std::to_string(p.grid.mixed_bricks) +
                          " bricks, at most " + std::to_string(gpu::kMostMixedBricks - 1) +
                          " are possible: choose a larger voxel"));
  p.mixed_brick = steps_.buffer("numbers of mixed bricks", p.grid.mixed_bricks);
  p.bricks = steps_.buffer("mixed bricks", p.grid.mixed_bricks, sizeof(gpu::Brick));
  if (!steps_.ok()) return;
  steps_.run_items(spirv::brick_assign, {}, {marks, p.brick_slot, p.mixed_brick},
                   static_cast<std::uint32_t>(brick_count()), brick_count());
  steps_.fill(p.bricks, 0);
}

/// Marks the boundary voxels, numbers them and lists the pairs.
VoxelPairs ListBuilder::list_pairs(const Items* lists, std::size_t count) {
  PartitionBuffers& p = body_.partition;
  VoxelPairs pairs;
  const VulkanBuffer unused = steps_.buffer("unused", 1);
  gpu::VoxelPush push{};
  push.origin = grid_.origin;
  push.size = grid_.size;
  push.bricks = grid_.bricks;
  push.growth = growth_;

  // Boundary bits, and how many pairs each item will give.
  std::vector<VulkanBuffer> counts(count);
  std::vector<std::uint32_t> totals(count);
  std::uint64_t total = 0;
  for (std::size_t i = 0; i < count; ++i) {
    push.count = lists[i].count;
    counts[i] = steps_.buffer("counts of voxels", std::uint64_t{lists[i].count} + 1);
    if (!steps_.ok() || push.count == 0) continue;
    steps_.run_items(spirv::voxel_list, {},
                     {body_.vertices, body_.triangles, lists[i].triangle, lists[i].cell, p.brick_slot,
                      p.bricks, counts[i], unused, unused, unused},
                     push, push.count);
    totals[i] = steps_.scan("pairs of triangle and voxel", counts[i], push.count);
    total += totals[i];
  }
  if (total >= 0xFFFFFFFFu)
    steps_.fail(bad_value("more than 4294967294 pairs of triangle and voxel: choose a larger voxel"));
  steps_.progress("boundary voxels", 0.4);

  // Compact numbers of the boundary voxels.
  const std::uint32_t slots = p.grid.mixed_bricks;
  VulkanBuffer sums = steps_.buffer("counts of boundary voxels", std::uint64_t{slots} + 1);
  if (!steps_.ok()) return pairs;
  steps_.run_items(spirv::brick_count, {}, {p.bricks, sums}, slots, slots);
  p.grid.boundary_voxels = steps_.scan("boundary voxels", sums, slots);
  p.boundary_place = steps_.buffer("places of boundary voxels", p.grid.boundary_voxels);
  p.list_begin = steps_.buffer("begins of voxels' lists", std::uint64_t{p.grid.boundary_voxels} + 1);
  pairs.count = static_cast<std::uint32_t>(total);
  pairs.triangle = steps_.buffer("pairs of triangle and voxel", total);
  pairs.voxel = steps_.buffer("pairs of triangle and voxel", total);
  if (!steps_.ok()) return pairs;
  steps_.run_items(spirv::brick_number, {}, {p.bricks, sums, p.boundary_place}, slots, slots);

  // The pairs, and how long each voxel's list is.
  steps_.fill(p.list_begin, 0);
  push.emit = 1;
  for (std::size_t i = 0; i < count; ++i) {
    push.count = lists[i].count;
    if (push.count > 0)
      steps_.run_items(spirv::voxel_list, {},
                       {body_.vertices, body_.triangles, lists[i].triangle, lists[i].cell, p.brick_slot,
                        p.bricks, counts[i], pairs.triangle, pairs.voxel, p.list_begin},
                       push, push.count);
    push.out_base += totals[i];
  }
  p.grid.list_entries = steps_.scan("pairs of triangle and voxel", p.list_begin, p.grid.boundary_voxels);
  return pairs;
}

/// Scatters the pairs into their lists, and sorts each.
void ListBuilder::scatter(VoxelPairs& pairs) {
  PartitionBuffers& p = body_.partition;
  const VulkanBuffer cursors =
      steps_.buffer("cursors of voxels' lists", std::uint64_t{p.grid.boundary_voxels} + 1);
  p.list_triangles = steps_.buffer("voxels' lists", pairs.count);
  pairs.entry_voxel = steps_.buffer("voxels of lists' entries", pairs.count);
  if (!steps_.ok()) return;
  steps_.run([&](CommandRecorder& r) { r.copy(p.list_begin, 0, cursors, 0, cursors.bytes()); });
  steps_.run_items(spirv::pair_scatter, {},
                   {pairs.triangle, pairs.voxel, cursors, p.list_triangles, pairs.entry_voxel}, pairs.count,
                   pairs.count);
  sort_lists(steps_, pairs.entry_voxel, p.list_begin, p.list_triangles, pairs.count);
}

VoxelPairs ListBuilder::build() {
  PartitionBuffers& p = body_.partition;
  p.grid.origin = grid_.origin;
  p.grid.size = grid_.size;
  p.grid.bricks = grid_.bricks;
  check_grid();
  steps_.progress("triangles to bricks", 0);
  const auto triangles = static_cast<std::uint32_t>(mesh_.triangles.size());
  Items lists[2];
  lists[0] = expand(gpu::kSourceSmall, {}, grid_.bricks, Int3(0), grid_.size * kBrickSide, triangles);
  lists[1] = large_triangles();
  steps_.progress("bricks to voxels", 0.2);
  mark_bricks(lists, 2);
  VoxelPairs pairs = list_pairs(lists, 2);
  steps_.progress("voxel lists", 0.6);
  scatter(pairs);
  return pairs;
}

}  // namespace

void check_lists(PrepareSteps& steps, const PartitionView& partition, const std::string& name) {
  std::uint32_t longest = 0;
  for (std::size_t i = 1; i < partition.list_begin.size(); ++i)
    longest = std::max(longest, partition.list_begin[i] - partition.list_begin[i - 1]);
  if (steps.ok() && longest > gpu::kLoopBudget)
    steps.fail(bad_value(std::to_string(longest) + " triangles of the " + name + " share a voxel, at most " +
                         std::to_string(gpu::kLoopBudget) +
                         " are possible on a device: choose a smaller voxel"));
}

std::uint32_t sort_lists(PrepareSteps& steps, const VulkanBuffer& entry_voxel, const VulkanBuffer& list_begin,
                         VulkanBuffer& lists, std::uint32_t entries) {
  VulkanBuffer sorted = steps.buffer("voxels' lists", entries);
  const VulkanBuffer longest = steps.buffer("longest list", 1);
  if (!steps.ok()) return 0;
  steps.fill(longest, 0);
  steps.run_items(spirv::list_rank, {}, {entry_voxel, list_begin, lists, sorted, longest}, entries, entries);
  std::swap(lists, sorted);
  const std::uint32_t bound = std::max(gpu::kRankSpan, steps.read(longest, 0));
  for (std::uint64_t run = gpu::kRankSpan; run < bound && steps.ok(); run *= 2) {
    struct {
      std::uint32_t count, run;
    } const push{entries, static_cast<std::uint32_t>(run)};
    steps.run_items(spirv::list_merge, {}, {entry_voxel, list_begin, lists, sorted}, push, entries);
    std::swap(lists, sorted);
  }
  return bound;
}

VoxelPairs build_lists(PrepareSteps& steps, const LatticeMesh& mesh, const VoxelGrid& grid,
                       std::int32_t growth, const char* name, BodyBuffers& body) {
  return ListBuilder(steps, mesh, grid, growth, name, body).build();
}

}  // namespace palpate

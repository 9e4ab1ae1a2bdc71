#include "compute/gpu/prepare/prepared_scene.h"

#include <algorithm>
#include <cstring>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "compute/gpu/partition_copy.h"
#include "compute/gpu/prepare/partition.h"
#include "compute/gpu/prepare/samples.h"
#include "compute/gpu/prepare/search_tables.h"
#include "compute/gpu/prepare/steps.h"
#include "compute/scene/scene_constants.h"
#include "model/mesh/orientation.h"
#include "shaders/shared/frame_field.h"

namespace palpate {
namespace {

/// A mesh's extra samples as shaders read them.
std::vector<gpu::ExtraSample> extras_of(const LatticeMesh& mesh) {
  std::vector<gpu::ExtraSample> out;
  out.reserve(mesh.extra_samples.size());
  for (const ExtraSample& extra : mesh.extra_samples) {
    gpu::ExtraSample& sample =
        out.emplace_back(gpu::ExtraSample{extra.triangle, extra.point, {extra.weight_q30}});
    std::ranges::copy(extra.coarse_q30, sample.weights + 1);
  }
  return out;
}

/// A mesh's sample levels as shaders read them.
std::vector<std::uint32_t> levels_of(const LatticeMesh& mesh) {
  static_assert(kSampleLevels == gpu::kMostSampleLevel && kSurfaceLevels == gpu::kMostSurfaceLevel);
  std::vector<std::uint32_t> out = mesh.levels_of;
  for (const SideLevels& side : mesh.side_levels) {
    out.push_back(side.coarsest);
    out.insert(out.end(), side.factor_q30.begin(), side.factor_q30.end());
  }
  return out;
}

/// Puts a mesh on the device as it is.
BodyBuffers upload_body(PrepareSteps& steps, const LatticeMesh& mesh, bool mockup, bool refined) {
  static const std::vector<std::uint32_t> none{0};
  BodyBuffers out;
  out.vertices = steps.filled("vertices", mesh.vertices);
  out.triangles = steps.filled("triangles", mesh.triangles);
  std::vector<std::uint32_t> info(mesh.triangles.size());
  for (std::size_t i = 0; i < info.size(); ++i)
    info[i] = mesh.flags[i] | static_cast<std::uint32_t>(mesh.sample_axis[i]) << gpu::kInfoAxisShift;
  if (refined)
    for (const ExtraSample& extra : mesh.extra_samples) info[extra.triangle] |= gpu::kInfoHasExtra;
  out.triangle_info = steps.filled("flags of triangles", info);
  out.unit_normal = steps.filled("normals", mesh.unit_normal_q30);
  out.field_weight = steps.filled("weights of samples", refined ? mesh.field_weight_q30 : none);
  out.patch = steps.filled("patches", mockup && refined ? mesh.patch : none);
  out.extras = steps.filled("extra samples", refined ? extras_of(mesh) : std::vector<gpu::ExtraSample>());
  out.levels = steps.filled("levels of samples", refined ? levels_of(mesh) : none);
  out.samples = steps.filled("numbers of samples", !mockup && refined ? mesh.grid_samples : none);
  out.neighbour_begin = steps.filled("neighbours", mockup ? mesh.neighbour_begin : none);
  out.neighbours = steps.filled("neighbours", mockup ? mesh.neighbours : none);
  return out;
}

void upload_bodies(PrepareSteps& steps, const SceneGeometry& geometry, const Plan& plan, PreparedScene& out) {
  const bool refined = plan.profile == Profile::kRefined;
  out.mockup = upload_body(steps, geometry.mockup, true, refined);
  out.tool = upload_body(steps, geometry.tool, false, refined);
}

/// Buffers of a partition that is not made: each can be bound.
void make_empty(PrepareSteps& steps, PartitionBuffers& p) {
  for (VulkanBuffer* buffer :
       {&p.brick_slot, &p.bricks, &p.mixed_brick, &p.boundary_place, &p.list_begin, &p.list_triangles}) {
    *buffer = steps.buffer("unused", 1);
    if (steps.ok()) steps.fill(*buffer, 0);
  }
}

void make_search_tables(PrepareSteps& steps, const SceneGeometry& geometry, bool refined,
                        PreparedScene& out) {
  steps.progress("search", 0.95);
  if (!steps.ok()) return;
  PartitionCopy lists;
  if (auto r = lists.read(steps.device(), out.mockup.partition); !r) return steps.fail(r.error());
  if (refined) check_lists(steps, lists.view(), "mock-up");
  out.occupied = steps.filled("what of the mock-up is not outside", occupied_words(lists.view()));
  out.list_boxes =
      steps.filled("boxes of the mock-up's triangles", list_boxes(geometry.mockup, lists.view()));
  if (!refined) return;
  const auto go_on = [&] {
    steps.progress("search", 0.95);
    return steps.ok();
  };
  out.mockup.tree = steps.texels("the mock-up's tree", tree_words(geometry.mockup, go_on));
  out.tool.tree = steps.texels("the tool's tree", tree_words(geometry.tool, go_on));
}

}  // namespace

std::uint64_t PreparedScene::memory_bytes() const {
  std::uint64_t sum = 0;
  for_each_buffer(*this, [&](const VulkanBuffer& buffer) { sum += buffer.bytes(); });
  return sum;
}

Result<void> upload_meshes(VulkanDevice& device, const SceneGeometry& geometry, const Plan& plan,
                           PreparedScene& out) {
  const Progress nobody;
  PrepareSteps steps(device, nobody);
  upload_bodies(steps, geometry, plan, out);
  if (!steps.ok()) return steps.error();
  return {};
}

Result<PreparedScene> share_scene(VulkanDevice& device, const PreparedScene& scene) {
  PreparedScene out;
  out.constants = scene.constants;
  std::vector<const PartitionBuffers*> partitions;
  for_each_partition(scene, [&](const PartitionBuffers& p) { partitions.push_back(&p); });
  std::size_t i = 0;
  for_each_partition(out, [&](PartitionBuffers& p) {
    const PartitionBuffers& from = *partitions[i++];
    p.grid = from.grid;
    p.has_internal = from.has_internal;
  });
  std::vector<const VulkanBuffer*> buffers;
  for_each_buffer(scene, [&](const VulkanBuffer& buffer) { buffers.push_back(&buffer); });
  i = 0;
  std::optional<Error> failed;
  for_each_buffer(out, [&](VulkanBuffer& buffer) {
    const VulkanBuffer& from = *buffers[i++];
    if (failed || !from) return;
    auto made = VulkanBuffer::alias(device, from);
    if (made)
      buffer = std::move(*made);
    else
      failed = made.error();
  });
  if (failed) return *failed;
  return out;
}

Result<PreparedScene> prepare_scene(VulkanDevice& device, const SceneGeometry& geometry, const Plan& plan,
                                    const Progress& progress) {
  const bool refined = plan.profile == Profile::kRefined;
  PrepareSteps steps(device, progress);
  PreparedScene out;
  upload_bodies(steps, geometry, plan, out);

  const VoxelPairs pairs =
      build_lists(steps, geometry.mockup, geometry.mockup_grid, 0, "mock-up", out.mockup);
  classify(steps, geometry.mockup, pairs, out.mockup);
  bool mockup_has_inside = geometry.mockup.closed, tool_has_inside = false;
  if (refined && !geometry.mockup.closed) {
    const bool bounds = count_shells(steps, pairs, out.mockup) && has_faces(geometry.mockup);
    mockup_has_inside = bounds || out.mockup.partition.has_internal;
  }
  make_search_tables(steps, geometry, refined, out);
  if (refined) {
    const VoxelPairs tool_pairs =
        build_lists(steps, geometry.tool, geometry.tool_grid, gpu::kToolVoxelGrowth, "tool", out.tool);
    classify(steps, geometry.tool, tool_pairs, out.tool);
    tool_has_inside = geometry.tool.closed;
    if (!geometry.tool.closed && has_faces(geometry.tool)) {
      tool_has_inside = count_shells(steps, tool_pairs, out.tool) || out.tool.partition.has_internal;
      if (!tool_has_inside) out.tool.partition.shells = {};
    }
    steps.progress("samples", 0.95);
    refine_tool(steps, geometry, out);
    list_tool_samples(steps, geometry, out);
    if (tool_has_inside) list_samples(steps, geometry, pairs, out);
  } else {
    make_empty(steps, out.tool.partition);
  }

  out.constants = scene_constants(geometry, plan,
                                  {.mockup = out.mockup.partition.grid,
                                   .tool = out.tool.partition.grid,
                                   .fine = out.fine.brick_slot ? out.fine.grid : out.tool.partition.grid,
                                   .mockup_has_inside = mockup_has_inside,
                                   .tool_has_inside = tool_has_inside});
  out.scene = steps.filled("constants", &out.constants, 1, sizeof out.constants);
  steps.progress("prepared", 1);
  if (!steps.ok()) return steps.error();
  return out;
}

}  // namespace palpate

#include "compute/gpu/prepare/samples.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <memory>
#include <utility>
#include <vector>

#include "compute/gpu/partition_copy.h"
#include "compute/scene/sample_points.h"
#include "compute/scene/samples.h"
#include "compute/scene/shares.h"
#include "compute/scene/tool_solid.h"
#include "model/lattice/sample_grid.h"
#include "model/scene/geometry_build.h"
#include "shaders/code.h"
#include "shaders/shared/frame.h"
#include "shaders/shared/frame_field.h"
#include "shaders/shared/prepare.h"

namespace palpate {
namespace {

constexpr std::uint64_t kSamplesARun =
    std::uint64_t{1} << 22;  // listed by one submission (chosen: 16 or 32 MiB; an entry has at most 2^12)
constexpr std::uint64_t kMostSampleBytes = std::uint64_t{1} << 30;  // on the host (chosen)

constexpr std::uint64_t kMostToolCells = std::uint64_t{1} << 26;    // looked at (chosen: a second or two)
constexpr std::uint64_t kMostToolSamples = std::uint64_t{1} << 22;  // (chosen: 64 MiB)
constexpr std::uint64_t kTileCells = 1024;                          // of an invocation (chosen)

/// A texel of kBindToolSamplePoints.
struct ToolSample {
  Int3 point;
  std::uint32_t level;
};

/// The boxes of triangles whose grid samples weigh something, in tiles. Empty where they have too many cells.
std::vector<gpu::ToolSampleTile> sample_tiles(const LatticeMesh& tool, std::int32_t spacing) {
  std::vector<gpu::ToolSampleTile> out;
  const SampleGrid grid{spacing};
  std::uint64_t all = 0;
  for (std::uint32_t id = 0; id < tool.triangles.size(); ++id) {
    if (tool.collapsed(id) || tool.field_weight_q30[id] == 0) continue;
    const int axis = tool.sample_axis[id], u = (axis + 1) % 3, v = (axis + 2) % 3;
    const Int3 a = tool.corner(id, 0), b = tool.corner(id, 1), c = tool.corner(id, 2);
    const auto [low_u, high_u] = std::minmax({a[u], b[u], c[u]});
    const auto [low_v, high_v] = std::minmax({a[v], b[v], c[v]});
    const std::int64_t first_u = grid.cell(low_u), first_v = grid.cell(low_v);
    const auto across = static_cast<std::uint64_t>(grid.cell(high_u) - first_u + 1),
               cells = across * static_cast<std::uint64_t>(grid.cell(high_v) - first_v + 1);
    all += cells;
    if (all > kMostToolCells) return {};
    for (std::uint64_t begin = 0; begin < cells; begin += kTileCells)
      out.push_back({id, static_cast<std::int32_t>(first_u), static_cast<std::int32_t>(first_v),
                     static_cast<std::uint32_t>(across), static_cast<std::uint32_t>(begin),
                     static_cast<std::uint32_t>(std::min(begin + kTileCells, cells))});
  }
  return out;
}

/// Voxel by voxel what has been listed entry by entry, in all. Left out where a buffer would be beyond the
/// device's limits.
void upload_points(PrepareSteps& steps, const SceneGeometry& geometry, const PartitionView& lists,
                   EntrySamples samples, PreparedScene& out) {
  const LatticeMesh& mesh = geometry.mockup;
  const std::uint32_t voxels = lists.grid.boundary_voxels;
  std::vector<std::uint32_t> begin(std::size_t{voxels} + 1);
  std::uint64_t count = 0;
  for (std::uint32_t voxel = 0; voxel < voxels; ++voxel) {
    begin[voxel] = static_cast<std::uint32_t>(count);
    for (std::uint32_t e = lists.list_begin[voxel]; e < lists.list_begin[voxel + 1]; ++e)
      count += samples.has_corner(e) ? 1u : 0u;
    count += samples.first(lists.list_begin[voxel + 1]) - samples.first(lists.list_begin[voxel]);
  }
  begin[voxels] = static_cast<std::uint32_t>(count);
  const std::size_t words = samples.wide ? 3 : 2;
  if (count * words * 4 > steps.device().limits().storage_range) return;

  VoxelSamples grid;  // to read them with
  grid.words = std::move(samples.words);
  grid.wide = samples.wide;
  std::vector<std::uint32_t> points(count * words), ids(count);
  const std::vector<std::uint32_t> shares = entry_shares(lists);
  const bool written = in_shares(
      static_cast<std::uint32_t>(shares.size() - 1),
      [&](std::uint32_t share) {
        for (std::uint32_t voxel = shares[share]; voxel < shares[share + 1]; ++voxel) {
          const VoxelSamples::Voxel cells(lists.grid.origin + lists.grid.size * lists.boundary_voxel(voxel),
                                          geometry.sample_spacing);
          std::size_t at = begin[voxel];
          const auto put = [&](const Int3& point, std::uint32_t id) {
            const Int3 d = point - cells.low;
            if (words == 3) {
              for (int k = 0; k < 3; ++k)
                points[3 * at + static_cast<std::size_t>(k)] = static_cast<std::uint32_t>(d[k]);
            } else {
              const std::uint64_t packed = static_cast<std::uint64_t>(d.x) |
                                           static_cast<std::uint64_t>(d.y) << 20 |
                                           static_cast<std::uint64_t>(d.z) << 40;
              points[2 * at] = static_cast<std::uint32_t>(packed);
              points[2 * at + 1] = static_cast<std::uint32_t>(packed >> 32);
            }
            ids[at++] = id;
          };
          for (std::uint32_t e = lists.list_begin[voxel]; e < lists.list_begin[voxel + 1]; ++e) {
            const std::uint32_t id = lists.list_triangles[e];
            if (samples.has_corner(e)) put(mesh.corner(id, 0), id | gpu::kCornerProbe);
            for (std::uint32_t i = samples.first(e); i < samples.first(e + 1); ++i)
              put(grid.sample(cells, samples.axis(e), i), id);
          }
        }
      },
      [&](std::uint32_t) {
        steps.progress("samples", 0.99);
        return steps.ok();
      });
  if (!written) return;
  out.sample_begin = steps.filled("samples of voxels", begin);
  out.sample_points = steps.filled("samples", points);
  out.sample_ids = steps.filled("triangles of samples", ids);
}

}  // namespace

void list_samples(PrepareSteps& steps, const SceneGeometry& geometry, const VoxelPairs& pairs,
                  PreparedScene& out) {
  if (!steps.ok()) return;
  const BodyBuffers& body = out.mockup;
  const PartitionBuffers& p = body.partition;
  gpu::SampleListPush push{};
  push.origin = p.grid.origin;
  push.size = p.grid.size;
  push.bricks = p.grid.bricks;
  push.spacing = geometry.sample_spacing;
  push.count = p.grid.list_entries;
  push.wide = p.grid.size > VoxelSamples::kNarrowVoxel ? 1 : 0;
  const VulkanBuffer begins = steps.buffer("begins of samples", std::uint64_t{push.count} + 1);
  const VulkanBuffer unused = steps.buffer("unused", 1);
  const auto run = [&](std::uint32_t emit, const VulkanBuffer& samples) {
    steps.run_items(spirv::sample_list, {emit},
                    {body.vertices, body.triangles, body.triangle_info, pairs.entry_voxel, p.list_triangles,
                     p.boundary_place, p.mixed_brick, begins, samples},
                    push, push.count);
  };
  if (!steps.ok()) return;
  run(0, unused);
  const std::uint64_t total = steps.scan("samples", begins, push.count), words = push.wide != 0 ? 2 : 1;
  if (!steps.ok() || total > EntrySamples::kBegin || total * words * 4 > kMostSampleBytes) return;
  EntrySamples samples;
  samples.wide = push.wide != 0;
  samples.begin.resize(std::size_t{p.grid.list_entries} + 1);
  samples.words.resize(total * words);
  if (auto r = download(steps.device(), begins, 0, samples.begin.data(), samples.begin.size() * 4); !r)
    return steps.fail(r.error());
  // Run by run, so that the device holds few of them at a time.
  const VulkanBuffer some = steps.buffer("samples of the mock-up", std::min(total, kSamplesARun) * words);
  const std::vector<std::uint32_t>& begin = samples.begin;
  for (auto from = begin.begin(), end = begin.end() - 1; from != end && steps.ok();) {
    const auto to = std::min(std::upper_bound(from + 1, begin.end(), *from + kSamplesARun) - 1, end);
    push.first = static_cast<std::uint32_t>(from - begin.begin());
    push.count = static_cast<std::uint32_t>(to - from);
    push.base = *from;
    run(1, some);
    if (!steps.ok()) return;
    if (auto r = download(steps.device(), some, 0, samples.words.data() + *from * words,
                          (*to - *from) * words * 4);
        !r)
      return steps.fail(r.error());
    steps.progress("samples", 0.95 + 0.04 * static_cast<double>(*to) / static_cast<double>(total + 1));
    from = to;
  }
  if (!steps.ok()) return;
  if (auto r = download(steps.device(), begins, 0, samples.begin.data(), samples.begin.size() * 4); !r)
    return steps.fail(r.error());
  PartitionCopy lists;
  if (auto r = lists.read(steps.device(), p); !r) return steps.fail(r.error());
  upload_points(steps, geometry, lists.view(), std::move(samples), out);
}

void list_tool_samples(PrepareSteps& steps, const SceneGeometry& geometry, PreparedScene& out) {
  if (!steps.ok()) return;
  const LatticeMesh& tool = geometry.tool;
  const std::vector<gpu::ToolSampleTile> tiles = sample_tiles(tool, geometry.sample_spacing);
  if (tiles.empty()) return;
  const gpu::ToolSamplePush push{static_cast<std::uint32_t>(tiles.size()), geometry.sample_spacing};
  const VulkanBuffer of_tiles = steps.filled("tiles of the tool's samples", tiles),
                     begins = steps.buffer("begins of the tool's samples", std::uint64_t{push.count} + 1),
                     unused = steps.buffer("unused", 4);
  const auto run = [&](std::uint32_t emit, const VulkanBuffer& samples) {
    steps.run_items(
        spirv::tool_sample_list, {emit},
        {out.tool.vertices, out.tool.triangles, out.tool.triangle_info, of_tiles, begins, samples}, push,
        push.count);
  };
  if (!steps.ok()) return;
  run(0, unused);
  const std::uint64_t total = steps.scan("samples of the tool", begins, push.count);
  if (!steps.ok() || total == 0 || total > kMostToolSamples) return;
  const VulkanBuffer samples = steps.buffer("the tool's samples", total, sizeof(ToolSample));
  if (!steps.ok()) return;
  run(1, samples);
  std::vector<std::uint32_t> begin(tiles.size() + 1);
  std::vector<ToolSample> listed(total);
  if (!steps.ok()) return;
  if (auto r = download(steps.device(), begins, 0, begin.data(), begin.size() * 4); !r)
    return steps.fail(r.error());
  if (auto r = download(steps.device(), samples, 0, listed.data(), listed.size() * sizeof(ToolSample)); !r)
    return steps.fail(r.error());

  constexpr std::size_t kWords = 4 * gpu::kSampleEndTexels;
  std::vector<std::uint32_t> ends(kWords * tool.triangles.size());
  for (std::size_t tile = 0; tile < tiles.size();) {
    const std::uint32_t triangle = tiles[tile].triangle;
    const auto first = listed.begin() + begin[tile];
    while (tile < tiles.size() && tiles[tile].triangle == triangle) ++tile;
    const auto last = listed.begin() + begin[tile];
    std::stable_sort(first, last, [](const ToolSample& a, const ToolSample& b) { return a.level > b.level; });
    std::uint32_t* const words = &ends[kWords * triangle];
    words[0] = static_cast<std::uint32_t>(first - listed.begin());
    for (std::uint32_t level = 0; level <= gpu::kMostSampleLevel; ++level)
      words[1 + level] = static_cast<std::uint32_t>(
          std::count_if(first, last, [&](const ToolSample& sample) { return sample.level >= level; }));
  }
  out.tool_sample_points = steps.filled("the tool's samples", listed.data(), listed.size(),
                                        sizeof(ToolSample), BufferKind::kTexels);
  out.tool_sample_ends = steps.texels("ends of the tool's samples", ends);
}

void refine_tool(PrepareSteps& steps, const SceneGeometry& geometry, PreparedScene& out) {
  if (!steps.ok()) return;
  const std::int32_t own_size = out.tool.partition.grid.size;
  if (const std::int32_t size = fine_voxel_size(geometry, out.tool.partition.grid); size != 0) {
    PartitionBuffers keep = std::exchange(out.tool.partition, PartitionBuffers{});
    const VoxelPairs pairs =
        build_lists(steps, geometry.tool, make_grid(geometry.tool.box_min, geometry.tool.box_max, size),
                    gpu::kToolVoxelGrowth, "tool", out.tool);
    classify(steps, geometry.tool, pairs, out.tool);
    out.fine = std::exchange(out.tool.partition, std::move(keep));
  }
  PartitionCopy fine;
  if (!steps.ok()) return;
  if (auto r = fine.read(steps.device(), out.fine.brick_slot ? out.fine : out.tool.partition); !r)
    return steps.fail(r.error());
  check_lists(steps, fine.view(), "tool");
  if (const auto near = near_tool(fine.view(), own_size); !near.empty())
    out.tool_near = steps.filled("voxels near the tool", near);
  if (geometry.tool.closed) out.fine_exit = steps.filled("ways out of the tool", ways_out(fine.view()));
}

}  // namespace palpate

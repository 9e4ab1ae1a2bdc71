#include "compute/gpu/prepare/samples.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <memory>
#include <utility>
#include <vector>

#include "compute/native/prepare/sample_lists.h"
#include "model/geometry_build.h"
#include "shaders/code.h"
#include "shaders/shared/frame.h"
#include "shaders/shared/prepare.h"

namespace palpate {
namespace {

constexpr std::int32_t kFiner = 4;                            // a fine voxel's side is that part of a voxel's (chosen: a sample's spacing)
constexpr std::uint64_t kMostFineVoxels = 4'000'000;          // boundary voxels, estimated (chosen: memory)
constexpr std::uint64_t kMostFineBricks = 8'000'000;
constexpr std::int32_t kMostFineRadius = 1 << 27;             // steps: up to it, rotations keep lengths to 0.3 steps (lib/tool_walk.glsl)
constexpr std::uint64_t kMostNearVoxels = std::uint64_t{1} << 29;
constexpr std::uint64_t kSamplesARun = std::uint64_t{1} << 22;   // listed by one submission (chosen: 16 or 32 MiB; an entry has at most 2^12)
constexpr std::uint64_t kMostSampleBytes = std::uint64_t{1} << 30;   // on the host (chosen)

/// A partition on the host.
struct Classes {
  gpu::GridConstants grid;
  std::vector<std::uint32_t> slots;
  std::vector<gpu::Brick> bricks;

  Classes(PrepareSteps& steps, const PartitionBuffers& p) : grid(p.grid), slots(count(p.grid.bricks)), bricks(p.grid.mixed_bricks) {
    if (auto r = download(steps.device(), p.brick_slot, 0, slots.data(), slots.size() * 4); !r) steps.fail(r.error());
    if (auto r = download(steps.device(), p.bricks, 0, bricks.data(), bricks.size() * sizeof bricks[0]); !r) steps.fail(r.error());
  }
  static std::size_t count(const gpu::ivec3& n) {
    return static_cast<std::size_t>(n.x) * static_cast<std::size_t>(n.y) * static_cast<std::size_t>(n.z);
  }
  /// kVoxel… of a voxel; V_ext beyond the grid.
  std::uint32_t of(const Int3& v) const {
    for (int k = 0; k < 3; ++k)
      if (v[k] < 0 || v[k] >= 8 * grid.bricks[k]) return gpu::kVoxelExternal;
    const Int3 b = v / 8;
    const std::uint32_t slot = slots[static_cast<std::size_t>(b.x) + static_cast<std::size_t>(grid.bricks.x) *
                                     (static_cast<std::size_t>(b.y) + static_cast<std::size_t>(grid.bricks.y) * static_cast<std::size_t>(b.z))];
    if (slot >= gpu::kBrickInternal) return slot == gpu::kBrickInternal ? gpu::kVoxelInternal : gpu::kVoxelExternal;
    const auto bit = static_cast<unsigned>((v.x & 7) | (v.y & 7) << 3 | (v.z & 7) << 6);
    if ((bricks[slot].boundary[bit >> 5] >> (bit & 31) & 1) != 0) return gpu::kVoxelBoundary;
    return (bricks[slot].internal_[bit >> 5] >> (bit & 31) & 1) != 0 ? gpu::kVoxelInternal : gpu::kVoxelExternal;
  }
};

/// The axis step that leads out of the solid through the fewest boundary voxels; every straight line leads out.
std::uint32_t way_out(const Classes& classes, const Int3& from) {
  std::uint32_t best = 0;
  int fewest = INT32_MAX;
  for (std::uint32_t step = 0; step < 6; ++step) {
    Int3 at = from;
    int crossed = 0;
    for (std::uint32_t c = gpu::kVoxelBoundary; c != gpu::kVoxelExternal && crossed < fewest; c = classes.of(at)) {
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

void find_exits(PrepareSteps& steps, const PartitionBuffers& p, PreparedScene& out) {
  const Classes classes(steps, p);
  std::vector<std::uint32_t> place(p.grid.boundary_voxels), number(p.grid.mixed_bricks), exits;
  if (auto r = download(steps.device(), p.boundary_place, 0, place.data(), place.size() * 4); !r) steps.fail(r.error());
  if (auto r = download(steps.device(), p.mixed_brick, 0, number.data(), number.size() * 4); !r) steps.fail(r.error());
  if (!steps.ok()) return;
  exits.reserve(place.size());
  for (const std::uint32_t at : place) {
    const std::uint32_t brick = number[at >> 9], bit = at & 511;
    const auto nx = static_cast<std::uint32_t>(p.grid.bricks.x), ny = static_cast<std::uint32_t>(p.grid.bricks.y);
    exits.push_back(way_out(classes, Int3(brick % nx, brick / nx % ny, brick / (nx * ny)) * 8 + Int3(bit & 7, bit >> 3 & 7, bit >> 6)));
  }
  out.fine_exit = steps.filled("ways out of the tool", exits);
}

/// Bits of the fine voxels whose centre is within a mock-up voxel's half diagonal of the tool's solid, from a centre anywhere in the
/// voxel: a ball of rows round each boundary voxel; V_int voxels are near anyway.
void find_near(PrepareSteps& steps, const PartitionBuffers& p, std::int32_t voxel_size, PreparedScene& out) {
  const Int3 n = p.grid.bricks * 8;
  const std::uint64_t voxels = Classes::count(p.grid.bricks) * 512;
  if (voxels > kMostNearVoxels) return;
  const Classes classes(steps, p);
  std::vector<std::uint32_t> place(p.grid.boundary_voxels), number(p.grid.mixed_bricks);
  if (auto r = download(steps.device(), p.boundary_place, 0, place.data(), place.size() * 4); !r) steps.fail(r.error());
  if (auto r = download(steps.device(), p.mixed_brick, 0, number.data(), number.size() * 4); !r) steps.fail(r.error());
  if (!steps.ok()) return;
  std::vector<std::uint8_t> near(voxels);
  std::size_t i = 0;
  for (int z = 0; z < n.z; ++z)
    for (int y = 0; y < n.y; ++y)
      for (int x = 0; x < n.x; ++x) near[i++] = classes.of({x, y, z}) != gpu::kVoxelExternal;

  // Two voxels whose index differs by d have points (|d| − 1)+ voxels apart an axis; rounding adds two steps.
  const double reach = (std::sqrt(0.75) * voxel_size + 4) / p.grid.size;
  const int most = static_cast<int>(reach) + 1;
  const auto gap = [](int d) { const double g = std::max(std::abs(d) - 1, 0); return g * g; };
  for (const std::uint32_t at : place) {
    const std::uint32_t brick = number[at >> 9], bit = at & 511;
    const auto nx = static_cast<std::uint32_t>(p.grid.bricks.x), ny = static_cast<std::uint32_t>(p.grid.bricks.y);
    const Int3 v = Int3(brick % nx, brick / nx % ny, brick / (nx * ny)) * 8 + Int3(bit & 7, bit >> 3 & 7, bit >> 6);
    for (int z = std::max(v.z - most, 0); z <= std::min(v.z + most, n.z - 1); ++z)
      for (int y = std::max(v.y - most, 0); y <= std::min(v.y + most, n.y - 1); ++y) {
        const double left = reach * reach - gap(z - v.z) - gap(y - v.y);
        if (left < 0) continue;
        const int wide = static_cast<int>(std::sqrt(left)) + 1;
        const std::size_t row = static_cast<std::size_t>(n.x) * (static_cast<std::size_t>(y) + static_cast<std::size_t>(n.y) * static_cast<std::size_t>(z));
        const int first = std::max(v.x - wide, 0), last = std::min(v.x + wide, n.x - 1);
        std::fill(near.begin() + static_cast<std::ptrdiff_t>(row) + first, near.begin() + static_cast<std::ptrdiff_t>(row) + last + 1, std::uint8_t{1});
      }
  }
  std::vector<std::uint32_t> bits(voxels / 32);
  for (i = 0; i < voxels; ++i) bits[i / 32] |= std::uint32_t{near[i]} << (i % 32);
  out.tool_near = steps.filled("voxels near the tool", bits);
}

/// What is listed entry by entry, voxel by voxel; then it is whole.
void list_points(PrepareSteps& steps, const HostPreparation& host, std::int32_t spacing, EntrySamples from, PreparedScene& out) {
  auto samples = std::make_shared<HostSamples>();
  const auto outcome = host.list_points(
      spacing,
      [&](double share) {
        steps.progress("samples", 0.99 + 0.01 * share);
        return steps.ok();
      },
      std::move(from), *samples);
  if (outcome == HostPreparation::Outcome::kDone) out.samples = std::move(samples);
}

void list_samples_on_host(PrepareSteps& steps, const SceneGeometry& geometry, PreparedScene& out) {
  const auto host = HostPreparation::make(steps.device(), geometry.mockup, out.mockup.partition);
  if (!host) return steps.fail(host.error());
  EntrySamples samples;
  const auto outcome = host->list_samples(
      geometry.sample_spacing, kMostSampleBytes,
      [&](double done) {
        steps.progress("samples", 0.95 + 0.04 * done);
        return steps.ok();
      },
      samples);
  if (outcome == HostPreparation::Outcome::kDone) list_points(steps, *host, geometry.sample_spacing, std::move(samples), out);
}

}  // namespace

void list_samples(PrepareSteps& steps, const SceneGeometry& geometry, const VoxelPairs& pairs, PreparedScene& out) {
  if (!steps.ok()) return;
  if (steps.device().host_share == HostShare::kContacts) return list_samples_on_host(steps, geometry, out);
  const BodyBuffers& body = out.mockup;
  const PartitionBuffers& p = body.partition;
  gpu::SampleListPush push{};
  push.origin = p.grid.origin;
  push.size = p.grid.size;
  push.bricks = p.grid.bricks;
  push.spacing = geometry.sample_spacing;
  push.count = p.grid.list_entries;
  push.wide = p.grid.size > HostSamples::kNarrowVoxel ? 1 : 0;
  const VulkanBuffer begins = steps.buffer("begins of samples", std::uint64_t{push.count} + 1);
  const VulkanBuffer unused = steps.buffer("unused", 1);
  const auto run = [&](std::uint32_t emit, const VulkanBuffer& samples) {
    steps.run_items(spirv::sample_list, {emit},
                    {body.vertices, body.triangles, body.triangle_info, pairs.entry_voxel, p.list_triangles, p.boundary_place, p.mixed_brick,
                     begins, samples},
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
  if (auto r = download(steps.device(), begins, 0, samples.begin.data(), samples.begin.size() * 4); !r) return steps.fail(r.error());
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
    if (auto r = download(steps.device(), some, 0, samples.words.data() + *from * words, (*to - *from) * words * 4); !r) return steps.fail(r.error());
    steps.progress("samples", 0.95 + 0.04 * static_cast<double>(*to) / static_cast<double>(total + 1));
    from = to;
  }
  if (!steps.ok()) return;
  if (auto r = download(steps.device(), begins, 0, samples.begin.data(), samples.begin.size() * 4); !r) return steps.fail(r.error());
  const auto host = HostPreparation::make(steps.device(), geometry.mockup, p);
  if (!host) return steps.fail(host.error());
  list_points(steps, *host, geometry.sample_spacing, std::move(samples), out);
}

void refine_tool(PrepareSteps& steps, const SceneGeometry& geometry, PreparedScene& out) {
  if (!steps.ok()) return;
  const PartitionBuffers& own = out.tool.partition;
  if (!geometry.tool.closed) return find_near(steps, own, own.grid.size, out);
  const std::int32_t size = own.grid.size / kFiner & ~1;
  const std::uint64_t more = std::uint64_t{kFiner} * kFiner;
  if (size >= 8 && geometry.tool_radius <= kMostFineRadius && own.grid.boundary_voxels * more <= kMostFineVoxels &&
      Classes::count(own.grid.bricks) * more * kFiner <= kMostFineBricks) {
    PartitionBuffers keep = std::exchange(out.tool.partition, PartitionBuffers{});
    const VoxelPairs pairs = build_lists(steps, geometry.tool, make_grid(geometry.tool.box_min, geometry.tool.box_max, size),
                                         gpu::kToolVoxelGrowth, "tool", out.tool);
    classify(steps, geometry.tool, pairs, out.tool);
    out.fine = std::exchange(out.tool.partition, std::move(keep));
  }
  const PartitionBuffers& fine = out.fine.brick_slot ? out.fine : out.tool.partition;
  find_near(steps, fine, own.grid.size, out);
  find_exits(steps, fine, out);
}

}  // namespace palpate

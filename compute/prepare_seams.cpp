#include "compute/prepare_seams.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <string>
#include <utility>
#include <vector>

#include "shaders/code.h"
#include "shaders/shared/prepare.h"

namespace palpate {
namespace {

using Pair = std::array<std::uint32_t, 2>;

Long3 raw_normal(const LatticeMesh& mesh, std::uint32_t t) {
  const Long3 a(mesh.corner(t, 0)), u = Long3(mesh.corner(t, 1)) - a, v = Long3(mesh.corner(t, 2)) - a;
  return {u.y * v.z - u.z * v.y, u.z * v.x - u.x * v.z, u.x * v.y - u.y * v.x};
}

/// Most pairs of entries of one voxel that are looked at, all voxels together (chosen: a minute of lavapipe on one core).
constexpr std::uint64_t kMostPairsInVoxels = std::uint64_t{1} << 36;

/// Fails where voxels hold so many triangles that comparing them with each other would take for ever.
void check_pairs(PrepareSteps& steps, const PartitionBuffers& p) {
  if (!steps.ok() || std::uint64_t{p.longest_list} * p.grid.list_entries <= kMostPairsInVoxels) return;
  std::vector<std::uint32_t> begin(std::size_t{p.grid.boundary_voxels} + 1);
  if (auto r = download(steps.device(), p.list_begin, 0, begin.data(), begin.size() * 4); !r) return steps.fail(r.error());
  std::uint64_t pairs = 0;
  for (std::size_t i = 1; i < begin.size(); ++i) pairs += std::uint64_t{begin[i] - begin[i - 1]} * (begin[i] - begin[i - 1]) / 2;
  if (pairs > kMostPairsInVoxels)
    steps.fail(bad_value(std::to_string(pairs) + " pairs of triangles share a voxel, at most " + std::to_string(kMostPairsInVoxels) +
                         " are compared for seams on a device: choose a smaller voxel"));
}

/// Pairs of triangles that may touch along a seam and whose unit normals don't rule a smooth angle out; each once, ascending.
std::vector<Pair> candidates(PrepareSteps& steps, const SceneGeometry& geometry, const VoxelPairs& listed,
                             const BodyBuffers& body) {
  const PartitionBuffers& p = body.partition;
  gpu::SeamPush push{};
  // Rounded unit normals err by less than 2^31 in their product, the cosine by less than 2^10: 2^34 is on the safe side.
  const SmoothAngle& angle = geometry.smooth_angle;
  const double cosine = std::sqrt(static_cast<double>(angle.cos2_numerator) / static_cast<double>(angle.cos2_denominator));
  push.least_cosine = static_cast<std::int64_t>(std::ldexp(cosine, 60)) - (std::int64_t{1} << 34);
  push.count = p.grid.list_entries;
  // Measured: 1.3 to 3 pairs a triangle; grown to what was found where that is not enough.
  push.capacity = 4 * static_cast<std::uint32_t>(geometry.mockup.triangles.size()) + 1024;

  const std::uint32_t rounds = (p.longest_list + gpu::kSeamSpan - 1) / gpu::kSeamSpan;
  check_pairs(steps, p);
  const VulkanBuffer found = steps.buffer("seams", 1);
  const VulkanBuffer boxes = steps.buffer("boxes of triangles in voxels", push.count);
  const gpu::GridPush grid{p.grid.origin, p.grid.size, p.grid.bricks, push.count, 0};
  if (!steps.ok()) return {};
  steps.run_items(spirv::seam_box, {},
                  {body.vertices, body.triangles, listed.entry_voxel, p.list_triangles, p.boundary_place, p.mixed_brick, boxes}, grid,
                  push.count);
  while (steps.ok()) {
    const VulkanBuffer pairs = steps.buffer("pairs of triangles at seams", push.capacity, sizeof(Pair));
    if (!steps.ok()) break;
    steps.fill(found, 0);
    for (push.round = 0; push.round < rounds; ++push.round)
      steps.run_items(spirv::seam_find, {},
                      {body.vertices, body.triangles, body.unit_normal, p.list_begin, p.list_triangles, found, pairs, boxes,
                       listed.entry_voxel},
                      push,
                      push.count);
    const std::uint32_t count = steps.read(found, 0);
    if (count > push.capacity) {
      push.capacity = count;
      continue;
    }
    std::vector<Pair> out(count);
    if (auto r = download(steps.device(), pairs, 0, out.data(), count * sizeof(Pair)); !r) steps.fail(r.error());
    std::sort(out.begin(), out.end());
    out.erase(std::unique(out.begin(), out.end()), out.end());
    return out;
  }
  return {};
}

/// Those of the pairs that touch along a seam.
std::vector<Pair> touching(PrepareSteps& steps, const std::vector<Pair>& pairs, const BodyBuffers& body) {
  std::vector<Pair> out;
  const VulkanBuffer in = steps.filled("pairs of triangles at seams", pairs);
  const VulkanBuffer answers = steps.buffer("pairs of triangles at seams", pairs.size());
  if (!steps.ok()) return out;
  steps.run_items(spirv::seam_test, {}, {body.vertices, body.triangles, in, answers}, static_cast<std::uint32_t>(pairs.size()),
                  pairs.size());
  std::vector<std::uint32_t> touches(pairs.size());
  if (auto r = download(steps.device(), answers, 0, touches.data(), touches.size() * 4); !r) steps.fail(r.error());
  for (std::size_t i = 0; i < pairs.size(); ++i)
    if (touches[i] != 0) out.push_back(pairs[i]);
  return out;
}

}  // namespace

void find_seams(PrepareSteps& steps, const SceneGeometry& geometry, bool refined, const VoxelPairs& pairs, BodyBuffers& body) {
  const LatticeMesh& mesh = geometry.mockup;
  std::vector<Pair> seams;
  if (refined) {
    for (const auto& [s, t] : touching(steps, candidates(steps, geometry, pairs, body), body))
      if (smooth(raw_normal(mesh, s), raw_normal(mesh, t), geometry.smooth_angle)) {
        seams.push_back({s, t});
        seams.push_back({t, s});
      }
    std::sort(seams.begin(), seams.end());
  }
  std::vector<std::uint32_t> begin(mesh.triangles.size() + 1, 0), ids;
  ids.reserve(seams.size());
  for (const auto& [s, t] : seams) {
    ++begin[s + 1];
    ids.push_back(t);
  }
  for (std::size_t i = 1; i < begin.size(); ++i) begin[i] += begin[i - 1];
  body.seam_begin = steps.filled("seams", begin);
  body.seams = steps.filled("seams", ids);
  body.seam_entries = static_cast<std::uint32_t>(ids.size());
}

}  // namespace palpate

#include "compute/prepare_seams.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "compute/prepare_on_host.h"
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

constexpr std::uint32_t kPairsARun = 1u << 21;     // candidates that there is room for at a time (chosen: 16 MiB; 1.3 to 3 come from a triangle)

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

/// What finding seams needs beside the lists, for a run of their entries.
class SeamSearch {
 public:
  SeamSearch(PrepareSteps& steps, const SceneGeometry& geometry, const VoxelPairs& listed, const BodyBuffers& body);

  /// All pairs that touch along a seam under a smooth angle, each once, the smaller id first, ascending.
  std::vector<Pair> all();

 private:
  bool find_on_host();
  void find_all();
  void make_boxes();
  std::uint32_t find(std::uint32_t first, std::uint32_t count);
  void keep_touching(std::span<const Pair> candidates);

  PrepareSteps& steps_;
  const LatticeMesh& mesh_;
  const SmoothAngle& angle_;
  const VoxelPairs& listed_;
  const BodyBuffers& body_;
  VulkanBuffer found_, boxes_, pairs_, some_, answers_;
  gpu::SeamPush push_{};
  std::vector<Pair> candidates_;
  std::vector<std::uint32_t> touches_;
  std::vector<Pair> seams_;
};

SeamSearch::SeamSearch(PrepareSteps& steps, const SceneGeometry& geometry, const VoxelPairs& listed, const BodyBuffers& body)
    : steps_(steps), mesh_(geometry.mockup), angle_(geometry.smooth_angle), listed_(listed), body_(body) {
  const PartitionBuffers& p = body.partition;
  // Rounded unit normals err by less than 2^31 in their product, the cosine by less than 2^10: 2^34 is on the safe side.
  const double cosine = std::sqrt(static_cast<double>(angle_.cos2_numerator) / static_cast<double>(angle_.cos2_denominator));
  push_.least_cosine = static_cast<std::int64_t>(std::ldexp(cosine, 60)) - (std::int64_t{1} << 34);
  push_.capacity = kPairsARun;
  check_pairs(steps, p);
  some_ = steps.buffer("pairs of triangles at seams", push_.capacity, sizeof(Pair));
  answers_ = steps.buffer("pairs of triangles at seams", push_.capacity);
}

/// What find() needs.
void SeamSearch::make_boxes() {
  const PartitionBuffers& p = body_.partition;
  found_ = steps_.buffer("seams", 1);
  boxes_ = steps_.buffer("boxes of triangles in voxels", p.grid.list_entries);
  pairs_ = steps_.buffer("pairs of triangles at seams", push_.capacity, sizeof(Pair));
  const gpu::GridPush grid{p.grid.origin, p.grid.size, p.grid.bricks, p.grid.list_entries, 0};
  if (!steps_.ok()) return;
  steps_.run_items(spirv::seam_box, {},
                   {body_.vertices, body_.triangles, listed_.entry_voxel, p.list_triangles, p.boundary_place, p.mixed_brick, boxes_}, grid,
                   grid.count);
}

/// Lists candidates with an entry of this run; returns how many there are, which may be more than there is room for.
std::uint32_t SeamSearch::find(std::uint32_t first, std::uint32_t count) {
  const PartitionBuffers& p = body_.partition;
  const std::uint32_t rounds = (p.longest_list + gpu::kSeamSpan - 1) / gpu::kSeamSpan;
  steps_.fill(found_, 0);
  push_.first = first;
  push_.count = count;
  for (push_.round = 0; push_.round < rounds; ++push_.round) {
    steps_.run_items(spirv::seam_find, {},
                     {body_.vertices, body_.triangles, body_.unit_normal, p.list_begin, p.list_triangles, found_, pairs_, boxes_, listed_.entry_voxel},
                     push_, count);
    if (push_.round % 64 == 63) steps_.progress("seams", 0.9);
  }
  return steps_.read(found_, 0);
}

/// Takes those of up to kPairsARun candidates that touch along a seam, exactly.
void SeamSearch::keep_touching(std::span<const Pair> candidates) {
  if (auto r = upload(steps_.device(), some_, candidates.data(), candidates.size() * sizeof(Pair)); !r) return steps_.fail(r.error());
  steps_.run_items(spirv::seam_test, {}, {body_.vertices, body_.triangles, some_, answers_}, static_cast<std::uint32_t>(candidates.size()),
                   candidates.size());
  if (!steps_.ok()) return;
  touches_.resize(candidates.size());
  if (auto r = download(steps_.device(), answers_, 0, touches_.data(), touches_.size() * 4); !r) return steps_.fail(r.error());
  for (std::size_t i = 0; i < candidates.size(); ++i)
    if (const auto& [s, t] = candidates[i]; touches_[i] != 0 && smooth(raw_normal(mesh_, s), raw_normal(mesh_, t), angle_)) seams_.push_back(candidates[i]);
}

/// False: the shaders have to, a few at a time.
bool SeamSearch::find_on_host() {
  if (!steps_.ok()) return true;
  const auto host = HostPreparation::make(steps_.device(), mesh_, body_.partition);
  if (!host) {
    steps_.fail(host.error());
    return true;
  }
  const auto outcome = host->find_seams(push_.least_cosine, [&](std::span<const Pair> candidates, double done) {
    for (; !candidates.empty() && steps_.ok(); candidates = candidates.subspan(std::min<std::size_t>(candidates.size(), kPairsARun)))
      keep_touching(candidates.first(std::min<std::size_t>(candidates.size(), kPairsARun)));
    steps_.progress("seams", 0.9 + 0.05 * done);
    return steps_.ok();
  });
  return outcome != HostPreparation::Outcome::kTooMany;
}

void SeamSearch::find_all() {
  make_boxes();
  const std::uint32_t entries = body_.partition.grid.list_entries;
  std::uint32_t run = seam_entries_a_run(body_.partition.longest_list);
  for (std::uint32_t first = 0; first < entries && steps_.ok();) {
    const std::uint32_t count = std::min(run, entries - first), pairs = find(first, count);
    if (!steps_.ok()) break;
    if (pairs > push_.capacity) {   // half as many at a time; an entry alone has room in any case but one that check_pairs() refuses
      if (count == 1) {
        steps_.fail(bad_value(std::to_string(pairs) + " triangles may continue one smoothly, at most " + std::to_string(push_.capacity) + " are possible"));
        break;
      }
      run = count / 2;
      continue;
    }
    if (pairs > 0) {
      candidates_.resize(pairs);
      if (auto r = download(steps_.device(), pairs_, 0, candidates_.data(), pairs * sizeof(Pair)); !r) return steps_.fail(r.error());
      // Most are found in several voxels, and those lie near each other.
      std::sort(candidates_.begin(), candidates_.end());
      candidates_.erase(std::unique(candidates_.begin(), candidates_.end()), candidates_.end());
      keep_touching(candidates_);
    }
    first += count;
    steps_.progress("seams", 0.9 + 0.05 * first / entries);
  }
}

std::vector<Pair> SeamSearch::all() {
  if (steps_.device().host_share != HostShare::kContacts || !find_on_host()) find_all();
  std::sort(seams_.begin(), seams_.end());
  seams_.erase(std::unique(seams_.begin(), seams_.end()), seams_.end());
  return std::move(seams_);
}

}  // namespace

std::uint32_t seam_entries_a_run(std::uint32_t longest_list) {
  constexpr std::uint32_t kEntriesARun = 1u << 20;   // chosen
  return std::clamp(~0u / std::max(longest_list, 1u), 1u, kEntriesARun);
}

void find_seams(PrepareSteps& steps, const SceneGeometry& geometry, bool refined, const VoxelPairs& pairs, BodyBuffers& body) {
  const LatticeMesh& mesh = geometry.mockup;
  std::vector<Pair> seams;
  if (refined && steps.ok()) {
    seams = SeamSearch(steps, geometry, pairs, body).all();
    const std::size_t found = seams.size();
    seams.reserve(2 * found);
    for (std::size_t i = 0; i < found; ++i) seams.push_back({seams[i][1], seams[i][0]});
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

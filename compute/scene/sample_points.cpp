#include "compute/scene/sample_points.h"

#include <algorithm>
#include <utility>

#include "compute/scene/shares.h"

namespace palpate {
namespace {

constexpr std::uint32_t kEntriesAShare = 1u << 14;  // of the voxels' lists (chosen: milliseconds)

/// A triangle whose first corner lies in a voxel: that vertex, and the entry of the voxel's list.
struct Owner {
  std::uint32_t vertex, entry;
  auto operator<=>(const Owner&) const = default;
};

}  // namespace

std::vector<std::uint32_t> entry_shares(const PartitionView& lists) {
  std::vector<std::uint32_t> begins{0};
  std::uint32_t last = 0;
  for (std::uint32_t voxel = 0; voxel < lists.grid.boundary_voxels; ++voxel) {
    if (lists.list_begin[voxel + 1] - last < kEntriesAShare) continue;
    last = lists.list_begin[voxel + 1];
    begins.push_back(voxel + 1);
  }
  if (begins.back() != lists.grid.boundary_voxels) begins.push_back(lists.grid.boundary_voxels);
  return begins;
}

Listing list_points(const LatticeMesh& mesh, const PartitionView& lists, std::int32_t spacing,
                    const ListingProgress& go_on, EntrySamples from, VoxelSamples& out) {
  const std::vector<std::uint32_t> shares = entry_shares(lists);
  const auto count = static_cast<std::uint32_t>(shares.size() - 1);
  out.begin.resize(std::size_t{lists.grid.boundary_voxels} + 1);
  for (std::uint32_t voxel = 0; voxel < lists.grid.boundary_voxels; ++voxel)
    if (lists.list_begin[voxel + 1] - lists.list_begin[voxel] > VoxelSamples::kLongestList)
      return Listing::kTooMany;
  // First how many there are in each voxel, then the numbers of its first ones.
  const auto in_voxels = [&](double begin, double part, auto&& take) {
    return in_shares(
        count,
        [&](std::uint32_t share) {
          std::vector<Owner> owners;
          for (std::uint32_t voxel = shares[share]; voxel < shares[share + 1]; ++voxel) {
            owners.clear();
            for (std::uint32_t e = lists.list_begin[voxel]; e < lists.list_begin[voxel + 1]; ++e)
              if (from.has_corner(e))
                owners.push_back({mesh.triangles[lists.list_triangles[e]][0], e - lists.list_begin[voxel]});
            std::sort(owners.begin(), owners.end());
            take(voxel, owners);
          }
        },
        [&](std::uint32_t begun) { return go_on(begin + part * begun / count); });
  };
  const bool counted = in_voxels(0, 0.4, [&](std::uint32_t voxel, const std::vector<Owner>& owners) {
    const std::uint32_t samples =
        from.first(lists.list_begin[voxel + 1]) - from.first(lists.list_begin[voxel]);
    std::uint32_t corners = 0;
    for (std::size_t i = 0; i < owners.size(); ++i)
      corners += i == 0 || owners[i].vertex != owners[i - 1].vertex ? 1u : 0u;
    out.begin[voxel] = {corners + samples, samples, static_cast<std::uint32_t>(owners.size())};
  });
  if (!counted) return Listing::kCancelled;
  VoxelSamples::Begin sum{};
  for (VoxelSamples::Begin& begin : out.begin) {
    const VoxelSamples::Begin size = std::exchange(begin, sum);
    sum = {sum.point + size.point, sum.sample + size.sample, sum.owner + size.owner};
  }
  out.points.resize(out.begin.back().point + (VoxelSamples::kPointsAtOnce - 1));
  out.entries.resize(out.begin.back().point);
  out.owners.resize(out.begin.back().owner);
  out.words = std::move(from.words);
  out.wide = from.wide;
  const bool written = in_voxels(0.4, 0.6, [&](std::uint32_t voxel, const std::vector<Owner>& owners) {
    const VoxelSamples::Voxel grid(lists.grid.origin + lists.grid.size * lists.boundary_voxel(voxel),
                                   spacing);
    std::uint32_t at = out.begin[voxel].point;
    const auto put = [&](const Int3& p, std::uint32_t entry, int axis) {
      std::uint32_t word = static_cast<std::uint32_t>(axis) << VoxelSamples::kAxisShift;
      for (int k = 0; k < 3; ++k)
        word |= static_cast<std::uint32_t>((std::int64_t{p[k] - grid.low[k]} << VoxelSamples::kPointBits) /
                                           lists.grid.size)
                << VoxelSamples::kPointBits * k;
      out.points[at] = word;
      out.entries[at++] = static_cast<std::uint16_t>(entry);
    };
    const std::uint32_t begin = lists.list_begin[voxel], end = lists.list_begin[voxel + 1];
    for (std::uint32_t i = 0; i < owners.size(); ++i) {
      if (i == 0 || owners[i].vertex != owners[i - 1].vertex) put(mesh.vertices[owners[i].vertex], i, 0);
      out.owners[out.begin[voxel].owner + i] = static_cast<std::uint16_t>(owners[i].entry);
    }
    for (std::uint32_t e = begin; e < end; ++e)
      for (std::uint32_t i = from.first(e); i < from.first(e + 1); ++i)
        put(out.sample(grid, from.axis(e), i), e - begin, from.axis(e));
  });
  return written ? Listing::kDone : Listing::kCancelled;
}

}  // namespace palpate

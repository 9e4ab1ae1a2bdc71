#include "compute/native/prepare/sample_lists.h"

#include <algorithm>
#include <atomic>
#include <bit>
#include <cmath>
#include <cstring>
#include <utility>

#include "compute/scene/exact.h"
#include "compute/scene/shares.h"

namespace palpate {
namespace {

constexpr std::uint32_t kEntriesAShare = 1u << 14;   // of the voxels' lists (chosen: milliseconds)

std::int64_t floor_div(std::int64_t a, std::int64_t b) {   // b > 0
  const std::int64_t q = a / b;
  return q - (a % b < 0 ? 1 : 0);
}

/// The first multiple of `spacing` not below v.
std::int64_t grid_from(std::int64_t v, std::int64_t spacing) { return -floor_div(-v, spacing) * spacing; }

/// Twice the area that edge pq spans with a grid point, times the triangle's facing, and more than 0 exactly where grid_side() says inside: a
/// point on the edge is moved by (ε, ε²). Steps along u and v are constant. Differences within 2^29 + 1.
struct EdgeSide {
  std::int64_t at, along_u, along_v;
  EdgeSide(const Int3& p, const Int3& q, int iu, int iv, int facing, std::int64_t u, std::int64_t v, std::int64_t spacing) {
    const std::int64_t du = std::int64_t{q[iu]} - p[iu], dv = std::int64_t{q[iv]} - p[iv];
    const int on_edge = dv != 0 ? (dv < 0 ? 1 : -1) : (du > 0 ? 1 : du < 0 ? -1 : 0);
    at = facing * (du * (v - p[iv]) - dv * (u - p[iu])) + (on_edge == facing ? 1 : 0);
    along_u = -facing * dv * spacing;
    along_v = facing * du * spacing;
  }
};

/// A triangle whose first corner lies in a voxel: that vertex, and the entry of the voxel's list.
struct Owner {
  std::uint32_t vertex, entry;
  auto operator<=>(const Owner&) const = default;
};

}  // namespace

Result<HostPreparation> HostPreparation::make(VulkanDevice& device, const LatticeMesh& mesh, const PartitionBuffers& lists) {
  HostPreparation out;
  out.mesh_ = &mesh;
  out.grid_ = lists.grid;
  if (auto r = out.list_begin_.read(device, lists.list_begin, std::size_t{lists.grid.boundary_voxels} + 1); !r) return r.error();
  if (auto r = out.list_triangles_.read(device, lists.list_triangles, lists.grid.list_entries); !r) return r.error();
  if (auto r = out.boundary_place_.read(device, lists.boundary_place, lists.grid.boundary_voxels); !r) return r.error();
  if (auto r = out.mixed_brick_.read(device, lists.mixed_brick, lists.grid.mixed_bricks); !r) return r.error();
  return out;
}

std::vector<std::uint32_t> HostPreparation::shares_of(std::uint32_t entries) const {
  std::vector<std::uint32_t> begins{0};
  std::uint32_t last = 0;
  for (std::uint32_t voxel = 0; voxel < grid_.boundary_voxels; ++voxel) {
    if (list_begin_[voxel + 1] - last < entries) continue;
    last = list_begin_[voxel + 1];
    begins.push_back(voxel + 1);
  }
  if (begins.back() != grid_.boundary_voxels) begins.push_back(grid_.boundary_voxels);
  return begins;
}

/// Lowest lattice point of a boundary voxel.
Int3 HostPreparation::low_of(std::uint32_t boundary) const {
  const std::uint32_t place = boundary_place_[boundary], brick = mixed_brick_[place >> 9], bit = place & 511;
  const auto nx = static_cast<std::uint32_t>(grid_.bricks.x), ny = static_cast<std::uint32_t>(grid_.bricks.y);
  return grid_.origin + grid_.size * (8 * Int3(brick % nx, brick / nx % ny, brick / (nx * ny)) + Int3(bit & 7, bit >> 3 & 7, bit >> 6));
}

/// Appends the samples of a voxel's entries to `words`, until there are more than `most_words`; `begin` gets each entry's begin in `words` with its
/// corner and axis.
void HostPreparation::sample_voxel(std::uint32_t boundary, std::int32_t spacing, std::uint64_t most_words, std::uint32_t* begin, std::vector<std::uint32_t>& words,
                                   bool wide) const {
  const Int3 low = low_of(boundary), high = low + (grid_.size - 1);   // the last lattice point of the half-open cube
  for (std::uint32_t e = list_begin_[boundary], end = list_begin_[boundary + 1]; e < end && words.size() <= most_words; ++e) {
    const std::uint32_t id = list_triangles_[e];
    const exact::Corners t{mesh_->corner(id, 0), mesh_->corner(id, 1), mesh_->corner(id, 2)};
    const int k = mesh_->sample_axis[id], iu = (k + 1) % 3, iv = (k + 2) % 3;
    const bool corner = glm::all(glm::greaterThanEqual(t[0], low)) && glm::all(glm::lessThanEqual(t[0], high));
    *begin++ = static_cast<std::uint32_t>(words.size() / (wide ? 2 : 1)) | (corner ? gpu::kSampleCorner : 0u) | static_cast<std::uint32_t>(k) << gpu::kSampleAxisShift;

    const Int3 least = glm::min(glm::min(t[0], t[1]), t[2]), most = glm::max(glm::max(t[0], t[1]), t[2]);
    const std::int64_t u0 = grid_from(std::max(low[iu], least[iu]), spacing), v0 = grid_from(std::max(low[iv], least[iv]), spacing);
    const std::int64_t u1 = std::min(high[iu], most[iu]), v1 = std::min(high[iv], most[iv]);
    if (u0 > u1 || v0 > v1) continue;
    const exact::Normal n = exact::raw_normal(t);
    const std::int64_t parts[3] = {n.x, n.y, n.z}, nk = parts[k];
    if (nk == 0) continue;   // collapsed
    const int facing = nk < 0 ? -1 : 1;
    const std::int64_t grid_u = grid_from(low[iu], spacing), grid_v = grid_from(low[iv], spacing), under = facing * nk;
    // |N_u|, |N_v| ≤ |N_k|: with differences below 2^extent the height's two products and their sum fit 64 bits.
    const std::int64_t extent = std::max(most[iu] - least[iu], most[iv] - least[iv]);
    const bool fits = extent == 0 || under <= (INT64_MAX >> 1) / extent;
    EdgeSide a(t[0], t[1], iu, iv, facing, u0, v0, spacing), b(t[1], t[2], iu, iv, facing, u0, v0, spacing), c(t[2], t[0], iu, iv, facing, u0, v0, spacing);
    for (std::int64_t v = v0; v <= v1; v += spacing) {
      std::int64_t at_a = a.at, at_b = b.at, at_c = c.at;
      for (std::int64_t u = u0; u <= u1; u += spacing, at_a += a.along_u, at_b += b.along_u, at_c += c.along_u) {
        if (at_a <= 0 || at_b <= 0 || at_c <= 0) continue;
        // floor(a_k − (N_u (u − a_u) + N_v (v − a_v)) / N_k), from the voxel's low side
        std::int64_t height = std::int64_t{t[0][k]} - low[k];
        const std::int64_t du = u - t[0][iu], dv = v - t[0][iv];
        if (fits) {
          height += floor_div(-facing * (parts[iu] * du + parts[iv] * dv), under);
        } else {
          const exact::Wide over = -facing * (exact::Wide{parts[iu]} * du + exact::Wide{parts[iv]} * dv), q = over / under;
          height += static_cast<std::int64_t>(over % under < 0 ? q - 1 : q);
        }
        if (height < 0 || height >= grid_.size) continue;
        const auto place = static_cast<std::uint32_t>((u - grid_u) / spacing) | static_cast<std::uint32_t>((v - grid_v) / spacing) << 6;
        if (wide) {
          words.push_back(static_cast<std::uint32_t>(height));
          words.push_back(place);
        } else {
          words.push_back(static_cast<std::uint32_t>(height) | place << 20);
        }
      }
      a.at += a.along_v;
      b.at += b.along_v;
      c.at += c.along_v;
    }
  }
}

HostPreparation::Outcome HostPreparation::list_samples(std::int32_t spacing, std::uint64_t most_bytes, const GoOn& go_on, EntrySamples& out) const {
  const std::vector<std::uint32_t> shares = shares_of(kEntriesAShare);
  const auto count = static_cast<std::uint32_t>(shares.size() - 1);
  out.wide = grid_.size > HostSamples::kNarrowVoxel;
  out.begin.resize(std::size_t{grid_.list_entries} + 1);
  std::vector<std::vector<std::uint32_t>> words(count);
  std::atomic<std::uint64_t> total{0};
  const std::uint64_t size = out.wide ? 2 : 1, most = std::min<std::uint64_t>(most_bytes / 4, size * EntrySamples::kBegin);
  const bool done = in_shares(
      count,
      [&](std::uint32_t share) {
        if (total > most) return;
        for (std::uint32_t voxel = shares[share]; voxel < shares[share + 1]; ++voxel) sample_voxel(voxel, spacing, most, &out.begin[list_begin_[voxel]], words[share], out.wide);
        total += words[share].size();
      },
      [&](std::uint32_t begun) { return go_on(0.9 * begun / count); });
  if (!done) return Outcome::kCancelled;
  if (total > most) return Outcome::kTooMany;
  out.words.reserve(total);
  for (std::uint32_t share = 0; share < count; ++share) {
    // Begins were counted from the share's first; they stay below gpu::kSampleCorner.
    const auto base = static_cast<std::uint32_t>(out.words.size() / size);
    for (std::uint32_t e = list_begin_[shares[share]], end = list_begin_[shares[share + 1]]; e < end; ++e) out.begin[e] += base;
    out.words.insert(out.words.end(), words[share].begin(), words[share].end());
    words[share] = {};
  }
  out.begin.back() = static_cast<std::uint32_t>(total / size);
  return go_on(1) ? Outcome::kDone : Outcome::kCancelled;
}

HostPreparation::Outcome HostPreparation::list_points(std::int32_t spacing, const GoOn& go_on, EntrySamples from, HostSamples& out) const {
  const std::vector<std::uint32_t> shares = shares_of(kEntriesAShare);
  const auto count = static_cast<std::uint32_t>(shares.size() - 1);
  out.begin.resize(std::size_t{grid_.boundary_voxels} + 1);
  for (std::uint32_t voxel = 0; voxel < grid_.boundary_voxels; ++voxel)
    if (list_begin_[voxel + 1] - list_begin_[voxel] > HostSamples::kLongestList) return Outcome::kTooMany;
  // First how many there are in each voxel, then the numbers of its first ones.
  const auto in_voxels = [&](double begin, double part, auto&& take) {
    return in_shares(
        count,
        [&](std::uint32_t share) {
          std::vector<Owner> owners;
          for (std::uint32_t voxel = shares[share]; voxel < shares[share + 1]; ++voxel) {
            owners.clear();
            for (std::uint32_t e = list_begin_[voxel]; e < list_begin_[voxel + 1]; ++e)
              if (from.has_corner(e)) owners.push_back({mesh_->triangles[list_triangles_[e]][0], e - list_begin_[voxel]});
            std::sort(owners.begin(), owners.end());
            take(voxel, owners);
          }
        },
        [&](std::uint32_t begun) { return go_on(begin + part * begun / count); });
  };
  const bool counted = in_voxels(0, 0.4, [&](std::uint32_t voxel, const std::vector<Owner>& owners) {
    const std::uint32_t samples = from.first(list_begin_[voxel + 1]) - from.first(list_begin_[voxel]);
    std::uint32_t corners = 0;
    for (std::size_t i = 0; i < owners.size(); ++i) corners += i == 0 || owners[i].vertex != owners[i - 1].vertex ? 1u : 0u;
    out.begin[voxel] = {corners + samples, samples, static_cast<std::uint32_t>(owners.size())};
  });
  if (!counted) return Outcome::kCancelled;
  HostSamples::Begin sum{};
  for (HostSamples::Begin& begin : out.begin) {
    const HostSamples::Begin size = std::exchange(begin, sum);
    sum = {sum.point + size.point, sum.sample + size.sample, sum.owner + size.owner};
  }
  out.points.resize(out.begin.back().point + (HostSamples::kPointsAtOnce - 1));
  out.entries.resize(out.begin.back().point);
  out.owners.resize(out.begin.back().owner);
  out.words = std::move(from.words);
  out.wide = from.wide;
  const bool written = in_voxels(0.4, 0.6, [&](std::uint32_t voxel, const std::vector<Owner>& owners) {
    const HostSamples::Voxel grid(low_of(voxel), spacing);
    std::uint32_t at = out.begin[voxel].point;
    const auto put = [&](const Int3& p, std::uint32_t entry, int axis) {
      std::uint32_t word = static_cast<std::uint32_t>(axis) << HostSamples::kAxisShift;
      for (int k = 0; k < 3; ++k) word |= static_cast<std::uint32_t>((std::int64_t{p[k] - grid.low[k]} << HostSamples::kPointBits) / grid_.size) << HostSamples::kPointBits * k;
      out.points[at] = word;
      out.entries[at++] = static_cast<std::uint16_t>(entry);
    };
    const std::uint32_t begin = list_begin_[voxel], end = list_begin_[voxel + 1];
    for (std::uint32_t i = 0; i < owners.size(); ++i) {
      if (i == 0 || owners[i].vertex != owners[i - 1].vertex) put(mesh_->vertices[owners[i].vertex], i, 0);
      out.owners[out.begin[voxel].owner + i] = static_cast<std::uint16_t>(owners[i].entry);
    }
    for (std::uint32_t e = begin; e < end; ++e)
      for (std::uint32_t i = from.first(e); i < from.first(e + 1); ++i) put(out.sample(grid, from.axis(e), i), e - begin, from.axis(e));
  });
  return written ? Outcome::kDone : Outcome::kCancelled;
}

}  // namespace palpate

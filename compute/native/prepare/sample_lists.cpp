#include "compute/native/prepare/sample_lists.h"

#include <algorithm>
#include <atomic>
#include <utility>

#include "compute/scene/exact.h"
#include "compute/scene/shares.h"

namespace palpate::native {
namespace {

std::int64_t floor_div(std::int64_t a, std::int64_t b) {  // b > 0
  const std::int64_t q = a / b;
  return q - (a % b < 0 ? 1 : 0);
}

/// Twice the area that edge pq spans with a point, times the triangle's facing, and more than 0 exactly where
/// grid_side() says inside: a point on the edge is moved by (ε, ε²). Differences within 2^29 + 1.
struct EdgeSide {
  std::int64_t from, along_u, along_v;
  EdgeSide(const Int3& p, const Int3& q, int iu, int iv, int facing) {
    const std::int64_t du = std::int64_t{q[iu]} - p[iu], dv = std::int64_t{q[iv]} - p[iv];
    const int on_edge = dv != 0 ? (dv < 0 ? 1 : -1) : (du > 0 ? 1 : du < 0 ? -1 : 0);
    along_u = -facing * dv;
    along_v = facing * du;
    from = (on_edge == facing ? 1 : 0) - along_u * p[iu] - along_v * p[iv];  // within 2^59
  }
  std::int64_t at(std::int64_t u, std::int64_t v) const { return from + along_u * u + along_v * v; }
};

/// Appends the samples of a voxel's entries to `words`, until there are more than `most_words`; `begin` gets
/// each entry's begin in `words` with its corner and axis.
void sample_voxel(const LatticeMesh& mesh, const PartitionView& lists, std::uint32_t boundary,
                  std::int32_t spacing, std::uint64_t most_words, std::uint32_t* begin,
                  std::vector<std::uint32_t>& words, bool wide) {
  const Int3 low = lists.grid.origin + lists.grid.size * lists.boundary_voxel(boundary),
             high = low + (lists.grid.size - 1);  // the last lattice point of the half-open cube
  const SampleGrid grid{spacing};
  for (std::uint32_t e = lists.list_begin[boundary], end = lists.list_begin[boundary + 1];
       e < end && words.size() <= most_words; ++e) {
    const std::uint32_t id = lists.list_triangles[e];
    const exact::Corners t{mesh.corner(id, 0), mesh.corner(id, 1), mesh.corner(id, 2)};
    const int k = mesh.sample_axis[id], iu = (k + 1) % 3, iv = (k + 2) % 3;
    const bool corner =
        glm::all(glm::greaterThanEqual(t[0], low)) && glm::all(glm::lessThanEqual(t[0], high));
    *begin++ = static_cast<std::uint32_t>(words.size() / (wide ? 2 : 1)) |
               (corner ? gpu::kSampleCorner : 0u) | static_cast<std::uint32_t>(k) << gpu::kSampleAxisShift;

    const Int3 least = glm::min(glm::min(t[0], t[1]), t[2]), most = glm::max(glm::max(t[0], t[1]), t[2]);
    const std::int64_t u0 = std::max(low[iu], least[iu]), v0 = std::max(low[iv], least[iv]),
                       u1 = std::min(high[iu], most[iu]), v1 = std::min(high[iv], most[iv]);
    if (u0 > u1 || v0 > v1) continue;
    const exact::Normal n = exact::raw_normal(t);
    const std::int64_t parts[3] = {n.x, n.y, n.z}, nk = parts[k];
    if (nk == 0) continue;  // collapsed
    const int facing = nk < 0 ? -1 : 1;
    const std::int64_t under = facing * nk;
    // |N_u|, |N_v| ≤ |N_k|: with differences below 2^extent the height's two products and their sum fit 64
    // bits.
    const std::int64_t extent = std::max(most[iu] - least[iu], most[iv] - least[iv]);
    const bool fits = extent == 0 || under <= (INT64_MAX >> 1) / extent;
    const EdgeSide a(t[0], t[1], iu, iv, facing), b(t[1], t[2], iu, iv, facing),
        c(t[2], t[0], iu, iv, facing);
    const std::int64_t first_i = grid.cell(low[iu]), first_j = grid.cell(low[iv]), last_i = grid.cell(u1),
                       last_j = grid.cell(v1);
    for (std::int64_t j = grid.cell(v0); j <= last_j; ++j) {
      for (std::int64_t i = grid.cell(u0); i <= last_i; ++i) {
        const std::int64_t u = grid.u(i, j), v = grid.v(i, j);
        if (u < u0 || u > u1 || v < v0 || v > v1 || a.at(u, v) <= 0 || b.at(u, v) <= 0 || c.at(u, v) <= 0)
          continue;
        // floor(a_k − (N_u (u − a_u) + N_v (v − a_v)) / N_k), from the voxel's low side
        std::int64_t height = std::int64_t{t[0][k]} - low[k];
        const std::int64_t du = u - t[0][iu], dv = v - t[0][iv];
        if (fits) {
          height += floor_div(-facing * (parts[iu] * du + parts[iv] * dv), under);
        } else {
          const exact::Wide over = -facing * (exact::Wide{parts[iu]} * du + exact::Wide{parts[iv]} * dv),
                            q = over / under;
          height += static_cast<std::int64_t>(over % under < 0 ? q - 1 : q);
        }
        if (height < 0 || height >= lists.grid.size) continue;
        const auto place = static_cast<std::uint32_t>(i - first_i) | static_cast<std::uint32_t>(j - first_j)
                                                                         << 6;
        if (wide) {
          words.push_back(static_cast<std::uint32_t>(height));
          words.push_back(place);
        } else {
          words.push_back(static_cast<std::uint32_t>(height) | place << 20);
        }
      }
    }
  }
}

}  // namespace

Listing list_samples(const LatticeMesh& mesh, const PartitionView& lists, std::int32_t spacing,
                     std::uint64_t most_bytes, const ListingProgress& go_on, EntrySamples& out) {
  const std::vector<std::uint32_t> shares = entry_shares(lists);
  const auto count = static_cast<std::uint32_t>(shares.size() - 1);
  out.wide = lists.grid.size > VoxelSamples::kNarrowVoxel;
  out.begin.resize(std::size_t{lists.grid.list_entries} + 1);
  std::vector<std::vector<std::uint32_t>> words(count);
  std::atomic<std::uint64_t> total{0};
  const std::uint64_t size = out.wide ? 2 : 1,
                      most = std::min<std::uint64_t>(most_bytes / 4, size * EntrySamples::kBegin);
  const bool done = in_shares(
      count,
      [&](std::uint32_t share) {
        if (total > most) return;
        for (std::uint32_t voxel = shares[share]; voxel < shares[share + 1]; ++voxel)
          sample_voxel(mesh, lists, voxel, spacing, most, &out.begin[lists.list_begin[voxel]], words[share],
                       out.wide);
        total += words[share].size();
      },
      [&](std::uint32_t begun) { return go_on(0.9 * begun / count); });
  if (!done) return Listing::kCancelled;
  if (total > most) return Listing::kTooMany;
  out.words.reserve(total);
  for (std::uint32_t share = 0; share < count; ++share) {
    // Begins were counted from the share's first; they stay below gpu::kSampleCorner.
    const auto base = static_cast<std::uint32_t>(out.words.size() / size);
    for (std::uint32_t e = lists.list_begin[shares[share]], end = lists.list_begin[shares[share + 1]];
         e < end; ++e)
      out.begin[e] += base;
    out.words.insert(out.words.end(), words[share].begin(), words[share].end());
    words[share] = {};
  }
  out.begin.back() = static_cast<std::uint32_t>(total / size);
  return go_on(1) ? Listing::kDone : Listing::kCancelled;
}

}  // namespace palpate::native

#include "model/mesh/patches.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numeric>
#include <span>
#include <vector>

#include "model/lattice/sample_grid.h"
#include "model/lattice/triangle.h"
#include "model/mesh/components.h"

namespace palpate {
namespace {

/// What the grid may miss or add of a side's area, and of the sum of its normals, as a part of its area
/// (chosen).
constexpr double kFairly = 0.0625;
/// Samples that stand for less than this part of a side can't stand for it all: weights are at most √3, and
/// 2√3 < 4 is what Q30 holds.
constexpr double kHardlySeen = 0.5;
/// How much of the identity there is in a side's tilt, in its area (chosen: a thousandth of the error is
/// left, and no weight is far from the others).
constexpr double kOpen = 1e-4;
/// Tilted weights stay within (chosen: a side that has to be tilted by more is seen badly; 2√3·1.15 < 4 is
/// what Q30 holds).
constexpr double kLeastTilt = 0.5, kMostTilt = 1.15;
/// Triangles of a side larger than s² share an extra sample as long as they are no larger than s², and reach
/// no further than this many s (chosen: sides that the grid misses are often narrow, and a contact across one
/// must not slip between).
constexpr double kExtraReach = 1.5;
/// So many samples a side keeps at its coarsest level, at least (chosen: about what a small contact has).
constexpr double kLeastOfLevel = 16;
/// Narrower than so many s a side has extra samples (chosen, on pins and needles): a round one, a flat one;
/// and from which sum of normals over area on it is flat.
constexpr double kNarrowRound = 4, kNarrow = 2, kFlat = 0.98;
/// They lie so many of its widths apart, no closer than this part of s (chosen).
constexpr double kOfWidth = 0.5, kClosest = 0.25;
/// A piece whose volume is below so many s of a quarter of its area is thin (chosen: a pin then holds no more
/// than about 64 of the other body's samples across).
constexpr double kThin = 9;
constexpr double kMostExtras = 1024;    // on one triangle (chosen: memory)
constexpr double kMostCells = 1 << 20;  // of a triangle whose samples are counted (chosen: milliseconds; what
                                        // so many miss of its area is a thousandth)
constexpr double kMostOfOne =
    3.99;  // 2^level s² that one extra sample stands for: below 4, which is what Q30 holds

struct Numbering {
  std::vector<std::uint32_t> of;  ///< by triangle, kNoPatch for collapsed ones
  std::uint32_t count = 0;
};

/// Numbers the components over edges between triangles that `together` allows, in the order of their smallest
/// triangle.
template <class Together>
Numbering number_joined(const LatticeMesh& mesh, const Together& together) {
  const auto count = static_cast<std::uint32_t>(mesh.triangles.size());
  Components components(count);
  for (std::uint32_t t = 0; t < count; ++t)
    for (std::uint32_t i = mesh.neighbour_begin[t]; i < mesh.neighbour_begin[t + 1]; ++i) {
      const EdgeNeighbour entry = mesh.neighbours[i];
      if (entry / 2 < t && together(t, entry / 2, (entry & 1) != 0)) components.join(t, entry / 2);
    }
  Numbering out{std::vector<std::uint32_t>(count, kNoPatch)};
  for (std::uint32_t t = 0; t < count; ++t) {
    if (mesh.collapsed(t)) continue;
    const std::uint32_t root = components.find(t);  // not after t, so it has its number
    out.of[t] = root == t ? out.count++ : out.of[root];
  }
  return out;
}

bool looks_back(const LatticeMesh& mesh, std::uint32_t triangle) {
  return mesh.unit_normal_q30[triangle][mesh.sample_axis[triangle]] < 0;
}

/// A weight, at least 2^-24, with which the field counts: an extra sample that weighs nothing would be none.
std::uint32_t weight_q30(double weight) {
  return static_cast<std::uint32_t>(std::clamp(std::nearbyint(weight * 0x1p30), 64.0, 4294967295.0));
}

/// Cuts a triangle across its longest edge into `count` strips of equal area; the centroid of number i of
/// them. (So what reaches into a long triangle from either end meets as much of its samples as of its area.)
Int3 middle_of_strip(const LatticeMesh& mesh, std::uint32_t triangle, std::int64_t i, std::int64_t count) {
  double longest = -1;
  int first = 0;
  for (int k = 0; k < 3; ++k) {
    const Vec3 edge = Vec3(mesh.corner(triangle, (k + 1) % 3)) - Vec3(mesh.corner(triangle, k));
    if (const double square = glm::dot(edge, edge); square > longest) longest = square, first = k;
  }
  const Vec3 p(mesh.corner(triangle, first)), q(mesh.corner(triangle, (first + 1) % 3)),
      apex(mesh.corner(triangle, (first + 2) % 3));
  // The apex stands over this part of the way from p to q. Before it the strips widen, behind it they narrow.
  const double foot = std::clamp(glm::dot(apex - p, q - p) / longest, 0.0, 1.0);
  const auto place_at = [&](double area) {  // on the way, that much of the triangle's area before it
    return area <= foot ? std::sqrt(area * foot) : 1 - std::sqrt((1 - area) * (1 - foot));
  };
  const auto number = static_cast<double>(count);
  const double begin = place_at(static_cast<double>(i) / number),
               end = place_at(static_cast<double>(i + 1) / number);
  Vec3 middle(0);
  const auto add = [&](const Vec3& tip, const Vec3& other, double base, double from, double to) {
    if (!(to > from && base > 0)) return;
    const double area = (to * to - from * from) / base,
                 moment = 2 * (to * to * to - from * from * from) / (3 * base);
    middle += area * tip + (moment / 2) * ((other - tip) + (apex - tip) / base);
  };
  add(p, q, foot, begin, std::min(end, foot));
  add(q, p, 1 - foot, 1 - end, 1 - std::max(begin, foot));
  Int3 out;
  for (int k = 0; k < 3; ++k) out[k] = static_cast<std::int32_t>(std::nearbyint(number * middle[k]));
  return out;
}

/// Area by where it faces, steps².
struct Facing {
  double area = 0;
  Vec3 sum{0};  ///< of n̂
  Vec3 spread{
      0};  ///< of |n̂|, each component by itself: a round side seen at its middle alone has the right sum
  void add(double more, const Vec3& normal) {
    area += more;
    sum += more * normal;
    spread += more * glm::abs(normal);
  }
};

/// What looks one way of a patch, and hangs together: all of it is sampled by the same columns of the grid.
struct Side {
  std::span<const std::uint32_t> triangles;  ///< ascending
  Facing facing{};
  double width = 0;                              ///< area over the length of its box's diagonal, steps
  std::array<Facing, kSampleLevels + 1> seen{};  ///< by samples of at least each level, s²·2^level for each
  std::vector<double> sampled{};  ///< by triangle: area that its samples stand for, s² for each
};

/// `square`: s².
void measure(const LatticeMesh& mesh, std::int32_t spacing, double square, Side& side) {
  Vec3 low(INFINITY), high(-INFINITY);
  for (const std::uint32_t t : side.triangles) {
    const Vec3 raw(raw_normal(mesh, t));
    const double size = length(raw);
    side.facing.add(size / 2, raw / size);
    for (int k = 0; k < 3; ++k) {
      low = glm::min(low, Vec3(mesh.corner(t, k)));
      high = glm::max(high, Vec3(mesh.corner(t, k)));
    }
    const auto samples = count_samples(mesh, t, spacing);
    side.sampled.push_back(square * samples[0] * (mesh.sample_weight_q30[t] * 0x1p-30));
    for (int level = 0; level <= kSampleLevels; ++level)
      if (const double count = samples[static_cast<std::size_t>(level)]; count != 0)
        side.seen[static_cast<std::size_t>(level)].add(
            std::ldexp(square, level) * count * (mesh.sample_weight_q30[t] * 0x1p-30), raw / size);
  }
  side.width = side.facing.area / length(high - low);
}

/// Whether a side is so narrow that a contact across it would meet too few of the grid's samples: a round one
/// sooner, for they have to see all ways that it faces.
bool is_narrow(double square, const Side& side) {
  const bool round = length(side.facing.sum) < kFlat * side.facing.area;
  return side.width < (round ? kNarrowRound : kNarrow) * std::sqrt(square);
}

/// The factor of the weights of its samples of at least `level` with which they stand for all of it; 0 when
/// they can't. `square`: s².
double factor_of(int level, const Side& side) {
  const Facing &is = side.facing, &seen = side.seen[static_cast<std::size_t>(level)];
  const double fair = kFairly * is.area;
  const auto fits = [&](double factor) {
    return length(factor * seen.sum - is.sum) <= fair && length(factor * seen.spread - is.spread) <= fair;
  };
  if (seen.area < kHardlySeen * is.area) return 0;
  const double factor = is.area / seen.area;
  return fits(factor) ? factor : 0;  // a round side seen only in places would push askew
}

/// What weights are worth by where their triangle faces: 1 + a + b·n̂.
struct Tilt {
  std::array<double, 4> of{};  ///< a, b
  double at(const Vec3& normal) const {
    return 1 + of[0] + of[1] * normal.x + of[2] * normal.y + of[3] * normal.z;
  }
};

/// With its weights times `factor`, how to tilt them so that a side's samples have its area and its sum of
/// normals exactly, or nearly so: least squares with a little of the identity, as a flat side leaves most of
/// it open. (A closed body under the same pressure all round is then pushed nowhere.)
Tilt tilt_of(const LatticeMesh& mesh, double factor, const Side& side) {
  double a[4][4] = {}, b[4] = {side.facing.area, side.facing.sum.x, side.facing.sum.y, side.facing.sum.z};
  for (std::size_t i = 0; i < side.triangles.size(); ++i) {
    if (side.sampled[i] == 0) continue;
    const Vec3 raw(raw_normal(mesh, side.triangles[i])), n = raw / length(raw);
    const double one[4] = {1, n.x, n.y, n.z}, weight = factor * side.sampled[i];
    for (int k = 0; k < 4; ++k) {
      b[k] -= weight * one[k];
      for (int l = 0; l < 4; ++l) a[k][l] += weight * one[k] * one[l];
    }
  }
  for (int k = 0; k < 4; ++k) a[k][k] += kOpen * side.facing.area;
  for (int k = 0; k < 4; ++k)  // symmetric and positive: no pivots
    for (int l = k + 1; l < 4; ++l) {
      const double share = a[l][k] / a[k][k];
      for (int m = k; m < 4; ++m) a[l][m] -= share * a[k][m];
      b[l] -= share * b[k];
    }
  Tilt out;
  for (int k = 4; k-- > 0;) {
    for (int l = k + 1; l < 4; ++l) b[k] -= a[k][l] * out.of[static_cast<std::size_t>(l)];
    out.of[static_cast<std::size_t>(k)] = b[k] / a[k][k];
  }
  return out;
}

/// The levels at which a side that the grid sees, with its weights times `grid_factor`, is still seen.
SideLevels levels_of(double square, double grid_factor, const Side& side) {
  SideLevels out;
  for (int level = 1; level <= kSampleLevels && side.facing.area >= kLeastOfLevel * std::ldexp(square, level);
       ++level) {
    const double factor = factor_of(level, side) / grid_factor;
    if (factor == 0 || factor >= 4) break;  // 4: what Q30 holds
    out.factor_q30[static_cast<std::size_t>(level - 1)] = weight_q30(factor);
    out.coarsest = static_cast<std::uint32_t>(level);
  }
  return out;
}

/// Gives a side extra samples for all of its area.
void place_extras(LatticeMesh& mesh, double square, const Side& side) {
  const double apart = std::clamp(kOfWidth * side.width, kClosest * std::sqrt(square), std::sqrt(square));
  const double share_of_one = apart * apart, most_reach = kExtraReach * apart;
  const bool one = side.facing.area <= share_of_one;
  double gathered = 0, most = -1;
  std::uint32_t largest = 0;
  Vec3 low(INFINITY), high(-INFINITY);  // of what is gathered
  for (std::size_t i = 0; i < side.triangles.size(); ++i) {
    const std::uint32_t t = side.triangles[i];
    const Vec3 raw(raw_normal(mesh, t));
    gathered += length(raw) / 2;
    if (const double shows = glm::dot(raw, side.facing.sum); shows > most) most = shows, largest = t;
    for (int k = 0; k < 3; ++k) {
      low = glm::min(low, Vec3(mesh.corner(t, k)));
      high = glm::max(high, Vec3(mesh.corner(t, k)));
    }
    const double reach = length(high - low);
    if (i + 1 < side.triangles.size() && (one || (gathered < share_of_one && reach < most_reach))) continue;
    const double weight = gathered / square;
    const double count =
        one ? 1
            : std::clamp(std::ceil(std::max(gathered / share_of_one, reach / most_reach)), 1.0, kMostExtras);
    const auto whole = static_cast<std::int64_t>(count);
    for (std::int64_t share = 0; share < whole; ++share)
      mesh.extra_samples.push_back(
          {largest, middle_of_strip(mesh, largest, share, whole), weight_q30(weight / count)});
    gathered = 0;
    most = -1;
    low = Vec3(INFINITY);
    high = Vec3(-INFINITY);
  }
}

/// Which of 27 ways a normal looks: along an axis no more than tan 22.5° is neither up nor down.
std::int64_t way_of(const Int3& normal) {
  constexpr std::int32_t kLeast = 444764242;  // tan 22.5° in Q30
  std::int64_t way = 0;
  for (int k = 2; k >= 0; --k)
    way = 3 * way + 1 + (normal[k] > kLeast ? 1 : 0) - (normal[k] < -kLeast ? 1 : 0);
  return way;
}

/// At a level extra samples of a patch that look one way, in a cube of so many s, are one.
std::int64_t cube_of_level(int level) { return std::int64_t{1} << level / 2; }

/// Fills coarse_q30: of extra samples that are one at a level, the one nearest to their middle and to where
/// they look on average stands for all.
void level_extras(std::int32_t spacing, LatticeMesh& mesh) {
  std::vector<ExtraSample>& extras = mesh.extra_samples;
  struct Keyed {
    std::array<std::int64_t, 5> key;  ///< patch, way, cube
    std::uint32_t extra;
    auto operator<=>(const Keyed&) const = default;
  };
  std::vector<Keyed> keyed(extras.size());
  // A patch counts from the corner of its own, so that it is cut the same wherever its body lies.
  std::vector<Int3> corner(mesh.patch_count, Int3(std::numeric_limits<std::int32_t>::max()));
  for (const ExtraSample& extra : extras)
    corner[mesh.patch[extra.triangle]] = glm::min(corner[mesh.patch[extra.triangle]], extra.point);
  for (int level = 1; level <= kSurfaceLevels; ++level) {
    const std::int64_t edge = spacing * cube_of_level(level);
    const auto place = [&](std::uint32_t i) {
      return extras[i].point - corner[mesh.patch[extras[i].triangle]];
    };
    for (std::uint32_t i = 0; i < extras.size(); ++i) {
      const std::uint32_t triangle = extras[i].triangle;
      keyed[i] = {{mesh.patch[triangle], way_of(mesh.unit_normal_q30[triangle]), place(i).x / edge,
                   place(i).y / edge, place(i).z / edge},
                  i};
    }
    std::sort(keyed.begin(), keyed.end());
    for (std::size_t first = 0, end = 0; first < keyed.size(); first = end) {
      double sum = 0;
      Vec3 middle(0), facing(0);
      for (end = first; end < keyed.size() && keyed[end].key == keyed[first].key; ++end) {
        const ExtraSample& extra = extras[keyed[end].extra];
        const double weight = extra.weight_q30 * 0x1p-30;
        if (end > first && sum + weight >= std::ldexp(kMostOfOne, level))
          break;  // the rest of the cube is another one
        sum += weight;
        middle += weight * Vec3(place(keyed[end].extra));
        facing += weight * 0x1p-30 * Vec3(mesh.unit_normal_q30[extra.triangle]);
      }
      double least = INFINITY;
      std::uint32_t chosen = 0;
      for (std::size_t i = first; i < end; ++i) {
        const ExtraSample& extra = extras[keyed[i].extra];
        const Vec3 away = (Vec3(place(keyed[i].extra)) - middle / sum) / static_cast<double>(edge),
                   turn = 0x1p-30 * Vec3(mesh.unit_normal_q30[extra.triangle]) - facing / sum;
        if (const double off = glm::dot(away, away) + glm::dot(turn, turn); off < least)
          least = off, chosen = keyed[i].extra;
      }
      extras[chosen].coarse_q30[static_cast<std::size_t>(level - 1)] = weight_q30(std::ldexp(sum, -level));
    }
  }
}

/// Whether each of a triangle's edges is run along as often one way as the other, by it and its neighbours.
bool edges_cancel(const LatticeMesh& mesh, std::uint32_t triangle) {
  for (std::size_t k = 0; k < 3; ++k) {
    const std::uint32_t p = mesh.triangles[triangle][k], q = mesh.triangles[triangle][(k + 1) % 3];
    int left = 1;
    for (std::uint32_t i = mesh.neighbour_begin[triangle]; i < mesh.neighbour_begin[triangle + 1]; ++i) {
      const auto& other = mesh.triangles[mesh.neighbours[i] / 2];
      for (std::size_t l = 0; l < 3; ++l) {
        const std::uint32_t from = other[l], to = other[(l + 1) % 3];
        left += (from == p && to == q ? 1 : 0) - (from == q && to == p ? 1 : 0);
      }
    }
    if (left != 0) return false;
  }
  return true;
}

}  // namespace

void find_patches(std::span<const std::uint32_t> part_of, LatticeMesh& mesh) {
  Numbering found = number_joined(mesh, [&](std::uint32_t a, std::uint32_t b, bool smooth) {
    return smooth && part_of[a] == part_of[b];
  });
  mesh.patch = std::move(found.of);
  mesh.patch_count = found.count;
}

std::array<double, kSampleLevels + 1> count_samples(const LatticeMesh& mesh, std::uint32_t triangle,
                                                    std::int32_t spacing) {
  std::array<double, kSampleLevels + 1> count{};
  if (mesh.collapsed(triangle)) return count;
  const int axis = mesh.sample_axis[triangle], u = (axis + 1) % 3, v = (axis + 2) % 3;
  const SampleGrid grid{spacing};
  const Int3 corners[3] = {mesh.corner(triangle, 0), mesh.corner(triangle, 1), mesh.corner(triangle, 2)};
  const auto [min_u, max_u] = std::minmax({corners[0][u], corners[1][u], corners[2][u]});
  const auto [min_v, max_v] = std::minmax({corners[0][v], corners[1][v], corners[2][v]});
  const std::int64_t first_i = grid.cell(min_u), last_i = grid.cell(max_u), first_j = grid.cell(min_v),
                     last_j = grid.cell(max_v);
  const Long3 raw = raw_normal(mesh, triangle);
  const std::int64_t facing = raw[axis] < 0 ? -1 : 1;
  if (static_cast<double>(last_i - first_i + 1) * static_cast<double>(last_j - first_j + 1) > kMostCells) {
    for (int level = 0; level <= kSampleLevels; ++level)
      count[static_cast<std::size_t>(level)] = std::ldexp(
          0.5 * std::abs(static_cast<double>(raw[axis])) / (double{1} * spacing * spacing), -level);
    return count;
  }
  for (std::int64_t j = first_j; j <= last_j; ++j)
    for (std::int64_t i = first_i; i <= last_i; ++i) {
      const std::int64_t at_u = grid.u(i, j), at_v = grid.v(i, j);
      bool inside = true;
      for (int k = 0; k < 3 && inside; ++k) {
        const Int3 &p = corners[k], &q = corners[(k + 1) % 3];
        const std::int64_t along_u = facing * (std::int64_t{q[u]} - p[u]),
                           along_v = facing * (std::int64_t{q[v]} - p[v]);
        const std::int64_t side = along_u * (at_v - p[v]) - along_v * (at_u - p[u]);  // within 2^59
        inside =
            side > 0 ||
            (side == 0 && (along_v < 0 || (along_v == 0 && along_u > 0)));  // on an edge: where (ε, ε²) says
      }
      if (!inside) continue;
      for (int level = SampleGrid::level(i, j); level >= 0; --level)
        count[static_cast<std::size_t>(level)] += 1;
    }
  return count;
}

void weigh_for_field(std::int32_t spacing, std::span<const Tip> tips, LatticeMesh& mesh) {
  const auto count = static_cast<std::uint32_t>(mesh.triangles.size());
  const double square = static_cast<double>(spacing) * spacing;
  std::vector<std::uint8_t> of_tip(count, 0);
  for (const Tip& tip : tips)
    for (const std::uint32_t t : tip.triangles) of_tip[t] = 1;
  const Numbering sides = number_joined(mesh, [&](std::uint32_t a, std::uint32_t b, bool smooth) {
    return smooth && of_tip[a] == 0 && of_tip[b] == 0 && !mesh.repeated(a) && !mesh.repeated(b) &&
           mesh.patch[a] == mesh.patch[b] && mesh.sample_axis[a] == mesh.sample_axis[b] &&
           looks_back(mesh, a) == looks_back(mesh, b);
  });
  std::vector<std::uint32_t> begin(std::size_t{sides.count} + 1, 0), order(count);
  for (const std::uint32_t side : sides.of)
    if (side != kNoPatch) ++begin[side + 1];
  std::partial_sum(begin.begin(), begin.end(), begin.begin());
  std::vector<std::uint32_t> next(begin.begin(), begin.end() - 1);
  for (std::uint32_t t = 0; t < count; ++t)
    if (sides.of[t] != kNoPatch) order[next[sides.of[t]]++] = t;

  mesh.field_weight_q30.assign(count, 0);
  mesh.extra_samples.clear();
  mesh.levels_of.assign(count, 0);
  mesh.side_levels.clear();
  for (std::uint32_t s = 0; s < sides.count; ++s) {
    Side side{.triangles = std::span(order).subspan(begin[s], begin[s + 1] - begin[s])};
    if (of_tip[side.triangles.front()] != 0 || mesh.repeated(side.triangles.front())) continue;
    measure(mesh, spacing, square, side);
    const double factor = is_narrow(square, side) ? 0 : factor_of(0, side);
    if (factor == 0) {
      place_extras(mesh, square, side);
      continue;
    }
    if (const SideLevels levels = levels_of(square, factor, side); levels.coarsest != 0) {
      mesh.side_levels.push_back(levels);
      for (const std::uint32_t t : side.triangles)
        mesh.levels_of[t] = static_cast<std::uint32_t>(mesh.side_levels.size());
    }
    const Tilt tilt = tilt_of(mesh, factor, side);
    for (const std::uint32_t t : side.triangles) {
      const Vec3 raw(raw_normal(mesh, t));
      mesh.field_weight_q30[t] =
          weight_q30(factor * std::clamp(tilt.at(raw / length(raw)), kLeastTilt, kMostTilt) *
                     (mesh.sample_weight_q30[t] * 0x1p-30));
    }
  }
  for (const Tip& tip : tips) sample_tip(spacing, tip, mesh);
  std::stable_sort(mesh.extra_samples.begin(), mesh.extra_samples.end(),
                   [](const ExtraSample& a, const ExtraSample& b) { return a.triangle < b.triangle; });
  level_extras(spacing, mesh);
}

void count_grid_samples(std::int32_t spacing, LatticeMesh& tool) {
  const auto count = static_cast<std::uint32_t>(tool.triangles.size());
  const std::uint32_t most = std::numeric_limits<std::uint32_t>::max() / std::max(count, 1U);
  tool.grid_samples.assign(count, 0);
  for (std::uint32_t t = 0; t < count; ++t)
    if (tool.field_weight_q30[t] != 0)
      tool.grid_samples[t] =
          static_cast<std::uint32_t>(std::min<double>(count_samples(tool, t, spacing)[0], most));
}

void mark_thin_pieces(std::int32_t spacing, std::span<const Tip> tips, LatticeMesh& mesh) {
  const auto count = static_cast<std::uint32_t>(mesh.triangles.size());
  const Numbering pieces = number_joined(mesh, [](std::uint32_t, std::uint32_t, bool) { return true; });
  struct Piece {
    bool closed = true;
    Vec3 origin{0};
    double volume = 0, area = 0;  // six and two times
  };
  std::vector<Piece> of(pieces.count);
  std::vector<std::uint8_t> begun(pieces.count, 0);
  for (std::uint32_t t = 0; t < count; ++t) {
    if (pieces.of[t] == kNoPatch) continue;
    Piece& piece = of[pieces.of[t]];
    if (begun[pieces.of[t]] == 0) piece.origin = Vec3(mesh.corner(t, 0)), begun[pieces.of[t]] = 1;
    const Vec3 raw(raw_normal(mesh, t));
    piece.area += length(raw);
    piece.volume += glm::dot(raw, Vec3(mesh.corner(t, 0)) - piece.origin);
    if (!edges_cancel(mesh, t)) piece.closed = false;
  }
  for (std::uint32_t t = 0; t < count; ++t) {
    mesh.flags[t] &= static_cast<std::uint8_t>(~kTriangleThin);
    if (pieces.of[t] == kNoPatch) continue;
    const Piece& piece = of[pieces.of[t]];  // 4 V / A = 4 (volume / 6) / (area / 2)
    if (piece.closed && piece.volume > 0 && 4 * piece.volume < 3 * kThin * spacing * piece.area)
      mesh.flags[t] |= kTriangleThin;
  }
  for (const Tip& tip : tips)
    for (const std::uint32_t t : tip.triangles) mesh.flags[t] |= kTriangleThin;
}

}  // namespace palpate

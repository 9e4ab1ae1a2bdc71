#include "model/mesh/tips.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <span>
#include <unordered_map>
#include <utility>

#include "model/lattice/triangle.h"

namespace palpate {
namespace {

/// The angles round an apex add up to less, and its normals, by area, to less than this part of their lengths
/// (chosen: a cone's with 30° between its axis and its side; of any other corner both say so).
constexpr double kPointed = std::numbers::pi, kCancels = 0.5;
/// Samples this part of their way from the apex apart, but no less than that part of s, and no more than s
/// (chosen, on cones).
constexpr double kOfWay = 0.25, kClosestOfWay = 0.125;
/// A ring has so many, or one for each side (chosen: what fewer say to either side of the axis may not
/// cancel).
constexpr double kLeastOfRing = 24;
/// A tip of more than so many s² has grid samples as any side (chosen: 19 MB).
constexpr double kMostOfTip = 1 << 19;
constexpr double kGolden = 0.6180339887498949;  // its fractional part

/// A triangle as its apex sees it.
struct Facet {
  std::uint32_t triangle;
  std::uint32_t first, second;  ///< vertices across from the apex
};

Facet facet_of(const LatticeMesh& mesh, std::uint32_t triangle, std::uint32_t apex) {
  const auto& corners = mesh.triangles[triangle];
  std::size_t k = 0;
  while (corners[k] != apex) ++k;
  return {triangle, corners[(k + 1) % 3], corners[(k + 2) % 3]};
}

double double_area(const LatticeMesh& mesh, std::uint32_t triangle) {
  return glm::length(Vec3(raw_normal(mesh, triangle)));
}

/// Each triangle with each of its corners whose normals mostly cancel, by ascending corner, then triangle. Of
/// all bodies few corners are such.
std::vector<std::pair<std::uint32_t, std::uint32_t>> round_corners(const LatticeMesh& mesh) {
  struct Normals {
    Vec3 sum{0};
    double size = 0;
  };
  std::vector<Normals> facing(mesh.vertices.size());
  const auto count = static_cast<std::uint32_t>(mesh.triangles.size());
  for (std::uint32_t t = 0; t < count; ++t) {
    if (mesh.repeated(t)) continue;
    const Vec3 raw(raw_normal(mesh, t));
    const double size = glm::length(raw);
    for (const std::uint32_t vertex : mesh.triangles[t]) {
      facing[vertex].sum += raw;
      facing[vertex].size += size;
    }
  }
  std::vector<std::pair<std::uint32_t, std::uint32_t>> out;
  for (std::uint32_t t = 0; t < count; ++t) {
    if (mesh.repeated(t)) continue;
    for (const std::uint32_t vertex : mesh.triangles[t])
      if (const Normals& of = facing[vertex];
          glm::dot(of.sum, of.sum) < kCancels * kCancels * of.size * of.size)
        out.emplace_back(vertex, t);
  }
  std::sort(out.begin(), out.end());
  return out;
}

/// Whether a corner points out of the body, and its triangles leave less than half a turn between them.
bool is_pointed(const LatticeMesh& mesh, std::uint32_t apex, std::span<const Facet> facets) {
  const Vec3 tip(mesh.vertices[apex]);
  double turn = 0;
  Vec3 into(0), normal(0);
  for (const Facet& facet : facets) {
    const Vec3 a = Vec3(mesh.vertices[facet.first]) - tip, b = Vec3(mesh.vertices[facet.second]) - tip,
               across = glm::cross(a, b);
    turn += std::atan2(glm::length(across), glm::dot(a, b));
    into += glm::length(across) * (a + b);
    normal += across;
  }
  return turn < kPointed && glm::dot(into, normal) < 0;
}

/// The triangles in their order round the apex, the first first; none where they don't close, or close twice.
std::vector<std::uint32_t> in_order(std::span<const Facet> facets) {
  std::unordered_map<std::uint32_t, const Facet*> beginning_at;
  for (const Facet& facet : facets)
    if (!beginning_at.emplace(facet.first, &facet).second) return {};
  std::vector<std::uint32_t> out;
  const Facet* facet = facets.data();
  do {
    out.push_back(facet->triangle);
    const auto next = beginning_at.find(facet->second);
    if (next == beginning_at.end()) return {};
    facet = next->second;
  } while (facet != facets.data() && out.size() < facets.size());
  if (facet != facets.data() || out.size() != facets.size()) return {};
  return out;
}

/// A side of a tip, from its apex to the edge across.
struct TipSide {
  Vec3 first, along;
  double area, before;  ///< its own, and that of the sides before it
};

}  // namespace

std::vector<Tip> find_tips(std::int32_t spacing, const LatticeMesh& mesh) {
  const auto corners = round_corners(mesh);
  std::vector<Tip> out;
  std::vector<Facet> facets;
  std::vector<bool> taken(corners.empty() ? 0 : mesh.triangles.size(), false);
  for (std::size_t first = 0, end = 0; first < corners.size(); first = end) {
    const std::uint32_t apex = corners[first].first;
    facets.clear();
    double area = 0;
    bool free = true;
    for (end = first; end < corners.size() && corners[end].first == apex; ++end) {
      const std::uint32_t triangle = corners[end].second;
      free = free && !taken[triangle] && !mesh.collapsed(triangle);
      facets.push_back(facet_of(mesh, triangle, apex));
      area += double_area(mesh, triangle) / 2;
    }
    if (!free || area > kMostOfTip * spacing * spacing || !is_pointed(mesh, apex, facets)) continue;
    Tip tip{apex, in_order(facets)};
    if (tip.triangles.empty()) continue;
    for (const std::uint32_t triangle : tip.triangles) taken[triangle] = true;
    out.push_back(std::move(tip));
  }
  return out;
}

void sample_tip(std::int32_t spacing, const Tip& tip, LatticeMesh& mesh) {
  const Vec3 apex(mesh.vertices[tip.apex]);
  std::vector<TipSide> sides;
  double area = 0, way = 0;  // from the apex to the edges across, on the mean
  for (const std::uint32_t t : tip.triangles) {
    const Facet facet = facet_of(mesh, t, tip.apex);
    const Vec3 a(mesh.vertices[facet.first]), b(mesh.vertices[facet.second]);
    const double own = double_area(mesh, t) / 2;
    sides.push_back({a, b - a, own, area});
    area += own;
    way += own * glm::length(0.5 * (a + b) - apex);
  }
  way /= area;
  const double s = spacing;
  // Rings between two parts of the way. All sides narrow alike, so a ring's area goes with their squares.
  double rings = 0;
  for (double begin = 0, end = 0; begin < 1; begin = end, rings += 1) {
    const double apart = std::clamp(kOfWay * begin * way, kClosestOfWay * s, s);
    end = begin + apart / way;
    if (end + 0.5 * apart / way > 1) end = 1;  // no sliver of a ring is left
    const double part = end * end - begin * begin,
                 middle = 2 * (end * end * end - begin * begin * begin) / (3 * part),
                 count = std::max(std::ceil(part * area / (apart * apart)),
                                  std::min(static_cast<double>(sides.size()), kLeastOfRing));
    const auto put = [&](std::size_t side, double along, double stands_for) {
      const Vec3 point = apex + middle * (sides[side].first + along * sides[side].along - apex);
      Int3 at;
      for (int k = 0; k < 3; ++k) at[k] = static_cast<std::int32_t>(std::nearbyint(point[k]));
      const double weight = std::clamp(std::nearbyint(stands_for / (s * s) * 0x1p30), 64.0, 4294967295.0);
      mesh.extra_samples.push_back({tip.triangles[side], at, static_cast<std::uint32_t>(weight)});
    };
    if (count >= static_cast<double>(sides.size())) {  // as many on either side of an axis
      for (std::size_t i = 0; i < sides.size(); ++i) {
        const double own = std::max(std::nearbyint(count * sides[i].area / area), 1.0);
        for (double k = 0; k < own; ++k) put(i, (k + 0.5) / own, part * sides[i].area / own);
      }
      continue;
    }
    const double offset = rings * kGolden - std::floor(rings * kGolden);  // so that rings don't lie in line
    std::size_t i = 0;
    for (double k = 0; k < count; ++k) {
      const double at = (k + offset) / count * area;
      while (i + 1 < sides.size() && sides[i + 1].before <= at) ++i;
      put(i, (at - sides[i].before) / sides[i].area, part * area / count);
    }
  }
}

}  // namespace palpate

#include "service/bench/error/cut_mesh.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <vector>

namespace palpate {
namespace {

using Corners = std::array<Vec3, 3>;

/// Hands each piece of a triangle to `emit`, until it returns false. Middles are means of two ends, which is
/// the same either way round, so that neighbours cut their edge at the same place.
template <class Emit>
bool cut(const Corners& t, double longest, const Emit& emit) {
  std::array<bool, 3> long_edge{};
  std::size_t count = 0;
  for (std::size_t k = 0; k < 3; ++k) {
    const Vec3 edge = t[(k + 1) % 3] - t[k];
    long_edge[k] = glm::dot(edge, edge) > longest * longest;
    if (long_edge[k]) ++count;
  }
  if (count == 0) return emit(t);
  const auto middle = [&](std::size_t k) { return 0.5 * (t[k % 3] + t[(k + 1) % 3]); };
  if (count == 3) {
    const Vec3 a = middle(0), b = middle(1), c = middle(2);
    return cut({t[0], a, c}, longest, emit) && cut({a, t[1], b}, longest, emit) &&
           cut({c, b, t[2]}, longest, emit) && cut({a, b, c}, longest, emit);
  }
  // Turned so that edge 0 is the only long one, or edge 2 the only short one.
  std::size_t first = 0;
  while (!(long_edge[first] && (count == 1 || long_edge[(first + 1) % 3]))) ++first;
  const Vec3 &p = t[first], &q = t[(first + 1) % 3], &r = t[(first + 2) % 3], a = middle(first);
  if (count == 1) return cut({p, a, r}, longest, emit) && cut({a, q, r}, longest, emit);
  const Vec3 b = middle(first + 1);
  return cut({a, q, b}, longest, emit) && cut({p, a, b}, longest, emit) && cut({p, b, r}, longest, emit);
}

Corners corners_of(const Mesh& mesh, std::size_t triangle) {
  const auto& t = mesh.triangles[triangle];
  return {mesh.vertices[t[0]], mesh.vertices[t[1]], mesh.vertices[t[2]]};
}

/// Whether pieces with edges up to `longest` are at most `most`.
bool within(const Mesh& mesh, double longest, std::uint64_t most) {
  std::uint64_t count = 0;
  for (std::size_t i = 0; i < mesh.triangles.size(); ++i)
    if (!cut(corners_of(mesh, i), longest, [&](const Corners&) { return ++count <= most; })) return false;
  return true;
}

}  // namespace

Mesh cut_to(const Mesh& mesh, std::uint64_t triangles) {
  if (mesh.triangles.size() >= triangles) return mesh;
  double longest = 0;
  for (std::size_t i = 0; i < mesh.triangles.size(); ++i) {
    const Corners t = corners_of(mesh, i);
    for (std::size_t k = 0; k < 3; ++k) longest = std::max(longest, glm::length(t[(k + 1) % 3] - t[k]));
  }
  double enough = longest, too_short = longest / 65536;
  for (int i = 0; i < 24; ++i) {
    const double tried = std::sqrt(enough * too_short);
    (within(mesh, tried, triangles) ? enough : too_short) = tried;
  }
  Mesh out;
  out.parts = mesh.parts;
  std::vector<std::uint32_t> first{0};  // piece of each triangle, and one past the last
  for (std::size_t i = 0; i < mesh.triangles.size(); ++i) {
    cut(corners_of(mesh, i), enough, [&](const Corners& t) {
      const auto at = static_cast<std::uint32_t>(out.vertices.size());
      out.vertices.insert(out.vertices.end(), t.begin(), t.end());
      out.triangles.push_back({at, at + 1, at + 2});
      return true;
    });
    first.push_back(static_cast<std::uint32_t>(out.triangles.size()));
  }
  for (MeshPart& part : out.parts) {
    const std::uint32_t end = first[part.first_triangle + part.triangle_count];
    part.first_triangle = first[part.first_triangle];
    part.triangle_count = end - part.first_triangle;
  }
  return out;
}

}  // namespace palpate

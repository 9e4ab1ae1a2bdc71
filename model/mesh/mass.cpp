#include "model/mesh/mass.h"

#include <algorithm>
#include <cmath>

#include "model/lattice/triangle.h"

namespace palpate {

SurfaceMeasure measure(const LatticeMesh& mesh) {
  SurfaceMeasure out;
  Vec3 area_moment(0), volume_moment(0);
  for (std::uint32_t t = 0; t < mesh.triangles.size(); ++t) {
    if (mesh.collapsed(t)) continue;
    const Vec3 a(mesh.corner(t, 0)), b(mesh.corner(t, 1)), c(mesh.corner(t, 2));
    const Vec3 normal(raw_normal(mesh, t));
    const double area = length(normal) / 2;
    const double volume =
        (a.x * normal.x + a.y * normal.y + a.z * normal.z) / 6;  // of the tetrahedron to the origin
    out.area += area;
    area_moment += area / 3 * (a + b + c);
    out.volume += volume;
    volume_moment += volume / 4 * (a + b + c);
    const auto squared = [](const Vec3& v) { return glm::dot(v, v); };
    out.longest_edges += std::sqrt(std::max({squared(b - a), squared(c - b), squared(a - c)}));
    out.triangles += 1;
  }
  if (out.area > 0) out.area_centroid = area_moment / out.area;
  if (out.volume > 0) out.volume_centroid = volume_moment / out.volume;
  return out;
}

double gyration_radius(const LatticeMesh& mesh, const Vec3& centre) {
  double area_sum = 0, moment = 0;
  for (std::uint32_t t = 0; t < mesh.triangles.size(); ++t) {
    if (mesh.collapsed(t)) continue;
    const Vec3 a = Vec3(mesh.corner(t, 0)) - centre, b = Vec3(mesh.corner(t, 1)) - centre,
               c = Vec3(mesh.corner(t, 2)) - centre;
    const double area = length(Vec3(raw_normal(mesh, t))) / 2;
    const Vec3 sum = a + b + c;
    // The integral over a triangle of |x|² is area / 12 · (|a|² + |b|² + |c|² + |a + b + c|²).
    moment += area / 12 * (glm::dot(a, a) + glm::dot(b, b) + glm::dot(c, c) + glm::dot(sum, sum));
    area_sum += area;
  }
  return area_sum > 0 ? std::sqrt(moment / area_sum) : 0;
}

}  // namespace palpate

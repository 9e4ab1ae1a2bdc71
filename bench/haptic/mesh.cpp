#include "bench/haptic/mesh.h"

#include <algorithm>
#include <cmath>

namespace yardstick {

Vec3 centre_of_volume(const TriMesh& mesh) {
  double volume = 0;
  Vec3 moment(0);
  for (const auto& t : mesh.triangles) {
    const Vec3 &a = mesh.vertices[t[0]], &b = mesh.vertices[t[1]], &c = mesh.vertices[t[2]];
    const double tetrahedron = glm::dot(a, glm::cross(b, c)) / 6;
    volume += tetrahedron;
    moment += tetrahedron / 4 * (a + b + c);
  }
  return volume != 0 ? moment / volume : Vec3(0);
}

double gyration_radius(const TriMesh& mesh) {
  double area_sum = 0, moment = 0;
  for (const auto& t : mesh.triangles) {
    const Vec3 &a = mesh.vertices[t[0]], &b = mesh.vertices[t[1]], &c = mesh.vertices[t[2]];
    const double area = glm::length(glm::cross(b - a, c - a)) / 2;
    // Over a triangle |x|² is quadratic: the three midpoints of its edges integrate it exactly.
    for (const Vec3& middle : {(a + b) / 2.0, (b + c) / 2.0, (c + a) / 2.0})
      moment += area / 3 * glm::dot(middle, middle);
    area_sum += area;
  }
  return area_sum > 0 ? std::sqrt(moment / area_sum) : 0;
}

double reach(const TriMesh& mesh) {
  double out = 0;
  for (const Vec3& v : mesh.vertices) out = std::max(out, glm::length(v));
  return out;
}

void append(TriMesh& mesh, const TriMesh& other) {
  const auto first = static_cast<std::uint32_t>(mesh.vertices.size());
  mesh.vertices.insert(mesh.vertices.end(), other.vertices.begin(), other.vertices.end());
  for (const auto& t : other.triangles) mesh.triangles.push_back({t[0] + first, t[1] + first, t[2] + first});
}

TriMesh shifted(TriMesh mesh, const Vec3& by) {
  for (Vec3& v : mesh.vertices) v += by;
  return mesh;
}

}  // namespace yardstick

#pragma once
#include <cmath>
#include <vector>

#include "cpu_ref/exact.h"

/// Closed solids straight on the lattice, outward oriented, made by hand: what a test about integers needs.
namespace palpate::cpu_ref {

inline std::vector<Triangle> lattice_box(const Int3& min, const Int3& max) {
  std::vector<Triangle> result;
  for (int k = 0; k < 3; ++k)
    for (const bool upper : {false, true}) {
      const int u = (k + 1) % 3, v = (k + 2) % 3;
      const auto corner = [&](int iu, int iv) {
        Int3 p;
        p[k] = upper ? max[k] : min[k];
        p[u] = iu ? max[u] : min[u];
        p[v] = iv ? max[v] : min[v];
        return p;
      };
      const Int3 a = corner(0, 0), b = corner(1, 0), c = corner(1, 1), d = corner(0, 1);
      if (upper) {
        result.emplace_back(a, b, c);
        result.emplace_back(a, c, d);
      } else {
        result.emplace_back(a, c, b);
        result.emplace_back(a, d, c);
      }
    }
  return result;
}

inline std::vector<Triangle> lattice_octahedron(int r) {
  std::vector<Triangle> result;
  for (const int x : {-r, r})
    for (const int y : {-r, r})
      for (const int z : {-r, r}) {
        const Int3 a(x, 0, 0), b(0, y, 0), c(0, 0, z);
        const bool even =
            (x < 0) == ((y < 0) == (z < 0));  // an odd number of mirrorings turns the triangle round
        result.push_back(even ? Triangle(a, c, b) : Triangle(a, b, c));
      }
  for (Triangle& t : result)
    if (t.side(Int3(0)) > 0) t = Triangle(t[0], t[2], t[1]);
  return result;
}

inline std::vector<Triangle> lattice_sphere(int radius, int segments, int rings) {
  const auto point = [&](int segment, int ring) {
    const double pi = 3.14159265358979323846, theta = pi * ring / rings,
                 phi = 2 * pi * (segment % segments) / segments;
    if (ring == 0 || ring == rings) return Int3(0, 0, ring == 0 ? radius : -radius);
    return Int3(static_cast<int>(std::lround(radius * std::sin(theta) * std::cos(phi))),
                static_cast<int>(std::lround(radius * std::sin(theta) * std::sin(phi))),
                static_cast<int>(std::lround(radius * std::cos(theta))));
  };
  std::vector<Triangle> result;
  for (int ring = 0; ring < rings; ++ring)
    for (int segment = 0; segment < segments; ++segment) {
      const Int3 a = point(segment, ring), b = point(segment, ring + 1), c = point(segment + 1, ring + 1),
                 d = point(segment + 1, ring);
      if (ring + 1 < rings) result.emplace_back(a, b, c);
      if (ring > 0) result.emplace_back(a, c, d);
    }
  return result;
}

}  // namespace palpate::cpu_ref

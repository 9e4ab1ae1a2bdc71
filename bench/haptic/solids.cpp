#include "bench/haptic/solids.h"

#include <cmath>

namespace yardstick {
namespace {

constexpr double kPi = 3.14159265358979323846;

/// A closed outline in the half plane (r, z), turned about z; it runs so that the body is on its left. Points
/// on the axis become one vertex.
TriMesh lathe(const std::vector<std::array<double, 2>>& outline, std::uint32_t sides, bool closed) {
  TriMesh out;
  std::vector<std::uint32_t> first;
  for (const auto& [r, z] : outline) {
    first.push_back(static_cast<std::uint32_t>(out.vertices.size()));
    if (r == 0) {
      out.vertices.emplace_back(0, 0, z);
      continue;
    }
    for (std::uint32_t i = 0; i < sides; ++i) {
      const double angle = 2 * kPi * (i + 0.5) / sides;  // half a side on: a flat, not a corner, along +x
      out.vertices.emplace_back(r * std::cos(angle), r * std::sin(angle), z);
    }
  }
  const std::size_t bands = closed ? outline.size() : outline.size() - 1;
  for (std::size_t band = 0; band < bands; ++band) {
    const std::size_t next = (band + 1) % outline.size();
    const bool point_here = outline[band][0] == 0, point_next = outline[next][0] == 0;
    for (std::uint32_t i = 0; i < sides; ++i) {
      const std::uint32_t j = (i + 1) % sides;
      const std::uint32_t a = first[band] + (point_here ? 0 : i), b = first[band] + (point_here ? 0 : j),
                          c = first[next] + (point_next ? 0 : j), d = first[next] + (point_next ? 0 : i);
      if (!point_here) out.triangles.push_back({a, b, c});
      if (!point_next) out.triangles.push_back({a, c, d});
    }
  }
  return out;
}

/// Of the corners, where the flats lie at `radius`.
double corner(double radius, std::uint32_t sides) { return radius / std::cos(kPi / sides); }

}  // namespace

TriMesh box(const Vec3& min, const Vec3& max) {
  TriMesh out;
  for (int i = 0; i < 8; ++i)
    out.vertices.emplace_back((i & 1) != 0 ? max.x : min.x, (i & 2) != 0 ? max.y : min.y,
                              (i & 4) != 0 ? max.z : min.z);
  out.triangles = {{0, 2, 3}, {0, 3, 1}, {4, 5, 7}, {4, 7, 6}, {0, 1, 5}, {0, 5, 4},
                   {2, 6, 7}, {2, 7, 3}, {0, 4, 6}, {0, 6, 2}, {1, 3, 7}, {1, 7, 5}};
  return out;
}

TriMesh sphere(double radius, std::uint32_t sides) {
  std::vector<std::array<double, 2>> outline{{0, -radius}};
  for (std::uint32_t i = 1; i < sides / 2; ++i) {
    const double angle = 2 * kPi * i / sides;
    outline.push_back({radius * std::sin(angle), -radius * std::cos(angle)});
  }
  outline.push_back({0, radius});
  return lathe(outline, sides, false);
}

TriMesh cone(double radius, double height, std::uint32_t sides) {
  return lathe({{0, 0}, {corner(radius, sides), height}, {0, height}}, sides, false);
}

TriMesh cylinder(double radius, double height, std::uint32_t sides) {
  const double r = corner(radius, sides), h = height / 2;
  return lathe({{0, -h}, {r, -h}, {r, h}, {0, h}}, sides, false);
}

TriMesh ring(double inner, double outer, double height, std::uint32_t sides) {
  const double a = corner(inner, sides), b = corner(outer, sides), h = height / 2;
  return lathe({{a, -h}, {b, -h}, {b, h}, {a, h}}, sides, true);
}

}  // namespace yardstick

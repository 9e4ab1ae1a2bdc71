// The bodies and motions of `bench stability`, in millimetres here.
#include <algorithm>
#include <array>
#include <cmath>
#include <utility>

#include "model/generate/solids.h"
#include "model/lattice/rotation.h"
#include "service/bench/stability/stability_contacts.h"

namespace palpate {
namespace {

constexpr double kMm = 1e-3;

Vec3 mm(double x, double y, double z) { return kMm * Vec3(x, y, z); }
Mesh box(const Vec3& min_mm, const Vec3& max_mm, int cells = 1) {
  return solids::box(kMm * min_mm, kMm * max_mm, Int3(cells));
}

Mesh together(const std::vector<Mesh>& meshes) {
  Mesh sum;
  for (const Mesh& mesh : meshes) solids::append(sum, mesh, "part" + std::to_string(sum.parts.size()));
  return sum;
}

/// A prism along y of a section made of rectangles in (x, z) that share whole sides: an L, a U. One connected
/// surface.
Mesh prism(const std::vector<double>& xs, const std::vector<double>& zs,
           const std::vector<std::pair<int, int>>& cells, double half_y) {
  const auto filled = [&](int i, int k) {
    return std::find(cells.begin(), cells.end(), std::pair{i, k}) != cells.end();
  };
  Mesh mesh;
  const auto quad = [&](const Vec3& a, const Vec3& b, const Vec3& c,
                        const Vec3& d) {  // counter-clockwise from outside
    const auto first = static_cast<std::uint32_t>(mesh.vertices.size());
    for (const Vec3& corner : {a, b, c, d}) mesh.vertices.push_back(kMm * corner);
    mesh.triangles.push_back({first, first + 1, first + 2});
    mesh.triangles.push_back({first, first + 2, first + 3});
  };
  for (const auto& [i, k] : cells) {
    const double x0 = xs[static_cast<std::size_t>(i)], x1 = xs[static_cast<std::size_t>(i) + 1];
    const double z0 = zs[static_cast<std::size_t>(k)], z1 = zs[static_cast<std::size_t>(k) + 1];
    const double y0 = -half_y, y1 = half_y;
    quad({x0, y0, z0}, {x1, y0, z0}, {x1, y0, z1}, {x0, y0, z1});
    quad({x0, y1, z0}, {x0, y1, z1}, {x1, y1, z1}, {x1, y1, z0});
    if (!filled(i, k + 1)) quad({x0, y0, z1}, {x1, y0, z1}, {x1, y1, z1}, {x0, y1, z1});
    if (!filled(i, k - 1)) quad({x0, y0, z0}, {x0, y1, z0}, {x1, y1, z0}, {x1, y0, z0});
    if (!filled(i + 1, k)) quad({x1, y0, z0}, {x1, y1, z0}, {x1, y1, z1}, {x1, y0, z1});
    if (!filled(i - 1, k)) quad({x0, y0, z0}, {x0, y0, z1}, {x0, y1, z1}, {x0, y1, z0});
  }
  mesh.parts = {{"", 0, static_cast<std::uint32_t>(mesh.triangles.size())}};
  return mesh;
}

Mesh block() { return box({-40, -40, -20}, {40, 40, 0}); }

Mesh pillars() {
  std::vector<Mesh> four;
  for (const double x : {-20.0, 20.0})
    for (const double y : {-20.0, 20.0}) four.push_back(box({x - 5, y - 5, -30}, {x + 5, y + 5, 0}));
  return together(four);
}

Mesh l_shape() { return prism({-60, 20, 50}, {-30, 0, 40}, {{0, 0}, {1, 0}, {1, 1}}, 50); }
Mesh u_shape() { return prism({-40, -4, 4, 40}, {-30, -1, 0}, {{0, 0}, {1, 0}, {2, 0}, {0, 1}, {2, 1}}, 40); }
/// Two blocks side by side, coplanar on top, their triangles not matching: a seam full of T-junctions.
Mesh seam() { return together({box({-40, -40, -20}, {0, 40, 0}, 1), box({0, -40, -20}, {40, 40, 0}, 3)}); }

Mesh sphere(double radius) { return solids::sphere(radius * kMm, 72, 36); }

Mesh peg() {
  return solids::moved(solids::cylinder(10 * kMm, 60 * kMm, 24), {mm(0, 0, -30), Quat(1, 0, 0, 0)});
}
Mesh hole(double radius) {
  return solids::moved(solids::ring(radius * kMm, 30 * kMm, 30 * kMm, 24), {mm(0, 0, -15), Quat(1, 0, 0, 0)});
}

/// Every triangle in four until no edge is longer than 5 mm: the chapter asks at triangles' centroids, so a
/// face of two would give it nothing.
Mesh finer(Mesh mesh) {
  const auto longest = [&] {
    double most = 0;
    for (const auto& t : mesh.triangles)
      for (std::size_t e = 0; e < 3; ++e)
        most = std::max(most, glm::length(mesh.vertices[t[e]] - mesh.vertices[t[(e + 1) % 3]]));
    return most;
  };
  while (longest() > 5 * kMm) {
    Mesh next;
    for (const auto& t : mesh.triangles) {
      const Vec3 a = mesh.vertices[t[0]], b = mesh.vertices[t[1]], c = mesh.vertices[t[2]];
      const auto first = static_cast<std::uint32_t>(next.vertices.size());
      next.vertices.insert(next.vertices.end(), {a, b, c, 0.5 * (a + b), 0.5 * (b + c), 0.5 * (c + a)});
      for (const auto& corner : {std::array<std::uint32_t, 3>{0, 3, 5}, {3, 1, 4}, {5, 4, 2}, {3, 4, 5}})
        next.triangles.push_back({first + corner[0], first + corner[1], first + corner[2]});
    }
    next.parts = {{"", 0, static_cast<std::uint32_t>(next.triangles.size())}};
    mesh = std::move(next);
  }
  return mesh;
}

/// Corner down: the cube's diagonal along z.
Quat corner_down() {
  const Vec3 diagonal = glm::normalize(Vec3(1, 1, 1)), down(0, 0, -1);
  const Vec3 axis = glm::normalize(glm::cross(diagonal, down));
  return rotation_by(std::acos(glm::dot(diagonal, down)) * axis);
}

/// From 0 to 1 and no further, over [from, to] s.
double ramp(double t, double from, double to) { return std::clamp((t - from) / (to - from), 0.0, 1.0); }

std::function<Pose(double)> at(const Vec3& position, const Quat& rotation = Quat(1, 0, 0, 0)) {
  return [=](double) { return Pose{position, rotation}; };
}
std::function<Pose(double)> moving(std::function<Vec3(double)> position) {
  return [position = std::move(position)](double t) { return Pose{position(t), Quat(1, 0, 0, 0)}; };
}

}  // namespace

std::vector<ContactCase> pressed_contacts() {
  const Mesh small = box({-20, -20, -10}, {20, 20, 0});
  // Places off the symmetries of the sample grid.
  return {
      {"flat", small, box({-10, -10, 0}, {10, 10, 20}), 1, at(mm(1.37, 2.11, -1))},
      {"sphere", small, sphere(25), 1, at(mm(1.37, 2.11, 25 - 3))},
      {"corner", small, box({-15, -15, -15}, {15, 15, 15}), 1,
       at(mm(1.37, 2.11, 15 * std::sqrt(3.0) - 4), corner_down())},
      {"pad", box({-5, -5, -30}, {5, 5, 0}), box({-30, -30, 0}, {30, 30, 10}), 1, at(mm(0.37, 0.61, -1))},
      {"four", pillars(), box({-30, -30, 0}, {30, 30, 10}), 1, at(mm(0.37, 0.61, -1))},
      // As large as the four together, so as stiff as they.
      {"wide pad", box({-10, -10, -30}, {10, 10, 0}), box({-30, -30, 0}, {30, 30, 10}), 1,
       at(mm(0.37, 0.61, -1))},
      // 20 mm in a hole 30 mm deep with 0.2 mm of play, tilted until both rims press, and 0.1 mm too thick.
      {"peg", hole(10.1), peg(), 1, at(mm(0.6, 0.3, 0), rotation_by(Vec3(0.02, 0.03, 0))), Vec3(1, 1, 0)},
      {"press fit", hole(9.95), peg(), 1, at(mm(0.1, 0.05, 0)), Vec3(1, 1, 0)},
  };
}

std::vector<ContactCase> jumping_motions() {
  const Mesh cube = box({-5, -5, 0}, {5, 5, 10});
  std::vector<ContactCase> cases{
      {"corner slide", l_shape(), cube, 1.2, moving([](double t) {
         return mm(-5 + 21 * ramp(t, 0.1, 0.6) - 21 * ramp(t, 0.7, 1.2), 0.3, 2 - 3 * ramp(t, 0, 0.1));
       })},
      {"edge roll-over", block(), box({-10, -10, 0}, {10, 10, 20}), 1.2,
       [](double t) {
         const Quat turn = rotation_by({0, 1.2 * ramp(t, 0.2, 1.0), 0});
         return Pose{mm(38, 0.3, 2 - 3 * ramp(t, 0, 0.2)), turn};
       }},
      {"peg in hole", solids::ring(10 * kMm, 25 * kMm, 30 * kMm, 64),
       solids::cylinder(9.8 * kMm, 40 * kMm, 64), 1.5, moving([](double t) {
         const double angle = 12 * t, sway = 0.8 * ramp(t, 0.2, 0.5);
         return mm(sway * std::cos(angle), sway * std::sin(angle), 32 - 25 * ramp(t, 0, 1.2));
       })},
      {"four contacts", pillars(), box({-30, -30, 0}, {30, 30, 10}), 1.5,
       [](double t) {
         const double sway = 0.05 * ramp(t, 0.2, 0.4);
         return Pose{mm(0, 0, 1 - 1.5 * ramp(t, 0, 0.2)),
                     rotation_by({sway * std::sin(9 * t), sway * std::cos(7 * t), 0})};
       }},
      {"pierced plate", box({-40, -40, -1}, {40, 40, 0}), sphere(10), 0.6,
       moving([](double t) { return mm(0.3, 0.2, 12 - 40 * ramp(t, 0, 0.6)); })},
      {"seam", seam(), sphere(15), 1.0,
       moving([](double t) { return mm(-15 + 30 * ramp(t, 0.2, 1.0), 0.7, 16 - 2 * ramp(t, 0, 0.2)); })},
      {"two pads, one", u_shape(), box({-15, -10, 0}, {15, 10, 20}), 1.2,
       moving([](double t) { return mm(0.3, 0.2, 1 - 2.6 * ramp(t, 0, 0.5) + 2.6 * ramp(t, 0.7, 1.2)); })},
      {"quick retreat", block(), box({-10, -10, 0}, {10, 10, 20}), 0.6,
       moving([](double t) { return mm(0.3, 0.2, 1 - 6 * ramp(t, 0, 0.4) + 100 * ramp(t, 0.5, 0.6)); })},
      {"fast impact", block(), box({-10, -10, 0}, {10, 10, 20}), 0.3,
       moving([](double t) { return mm(0.3, 0.2, 45 - 50 * ramp(t, 0.05, 0.1)); })},
      {"grazing", block(), sphere(15), 1.0, moving([](double t) {
         return mm(-20 + 40 * t, 0.2, 15 + 0.05 - 0.1 * ramp(t, 0, 0.5) + 0.1 * ramp(t, 0.5, 1));
       })},
      {"resting", block(), box({-10, -10, 0}, {10, 10, 20}), 1.0, moving([](double t) {
         return mm(0.01 * std::sin(50 * t), 0.01 * std::cos(47 * t),
                   1 - 2 * ramp(t, 0, 0.2) + 0.01 * std::sin(60 * t));
       })},
  };
  for (ContactCase& what : cases)
    what.mockup = finer(std::move(what.mockup)), what.tool = finer(std::move(what.tool));
  return cases;
}

}  // namespace palpate

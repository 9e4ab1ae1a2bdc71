#include "model/mesh/winding_number.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <random>

#include "model/generate/solids.h"
#include "model/scene/geometry_build.h"

namespace palpate {
namespace {

constexpr double kOff = 0.05;  // a fifth of the quarter by which a triangle comes to be in doubt

struct Built {
  Lattice lattice;
  LatticeMesh mesh;
  /// At a point in metres.
  double winding_at(const Vec3& point) const {
    return WindingNumber(mesh).at((point - lattice.origin_m) / lattice.step_m);
  }
};

Built build(const Mesh& mesh) {
  Built out;
  out.lattice = choose_lattice(mesh, {}).value();
  MeshReport report;
  auto built = build_lattice_mesh(mesh, out.lattice, {}, report);
  EXPECT_TRUE(built) << built.error().sentence;
  out.mesh = std::move(*built);
  return out;
}

/// A ball of radius 1 without the cap that is seen from its middle within an angle of the z axis.
Mesh ball_without_cap(double angle) {
  Mesh mesh = solids::sphere(1, 192, 96);
  std::erase_if(mesh.triangles, [&](const auto& t) {
    const Vec3 middle = (mesh.vertices[t[0]] + mesh.vertices[t[1]] + mesh.vertices[t[2]]) / 3.0;
    return std::atan2(std::hypot(middle.x, middle.y), middle.z) < angle;
  });
  mesh.parts.front().triangle_count = static_cast<std::uint32_t>(mesh.triangles.size());
  return mesh;
}

TEST(WindingNumber, OfAClosedSurfaceIsOneInsideAndNoneOutside) {
  const Built torus = build(solids::torus(0.3, 0.1));
  const WindingNumber winding(torus.mesh);
  std::mt19937 random(1);
  std::uniform_real_distribution<double> place(-0.5, 0.5);
  std::size_t inside = 0;
  for (int i = 0; i < 4000; ++i) {
    const double x = place(random), y = place(random), z = place(random) / 3;
    const double away = std::hypot(std::hypot(x, y) - 0.3, z);
    if (std::abs(away - 0.1) < 0.003) continue;  // between the torus and its facets
    const double truth = away < 0.1 ? 1 : 0;
    inside += away < 0.1 ? 1 : 0;
    EXPECT_NEAR(winding.at((Vec3(x, y, z) - torus.lattice.origin_m) / torus.lattice.step_m), truth, kOff);
  }
  EXPECT_GT(inside, 300u);
}

TEST(WindingNumber, LacksTheSolidAngleOfAHole) {
  // From (0, 0, z) the cap's rim, at height c and distance s, is a cone's of cos α = (c − z) / |(s, c − z)|.
  for (const double degrees : {30.0, 45.0, 60.0}) {
    const double angle = degrees * std::numbers::pi / 180, c = std::cos(angle), s = std::sin(angle);
    const Built ball = build(ball_without_cap(angle));
    for (const double z : {-0.8, -0.3, 0.0, 0.4})
      EXPECT_NEAR(ball.winding_at({0, 0, z}), 1 - (1 - (c - z) / std::hypot(s, c - z)) / 2, kOff)
          << degrees << " " << z;
    EXPECT_NEAR(ball.winding_at({0, 0, 2}), (1 - (2 - c) / std::hypot(s, 2 - c)) / 2, kOff) << degrees;
  }
}

TEST(WindingNumber, KnowsNoSheets) {
  Mesh mesh = solids::box(Vec3(0), Vec3(1));
  mesh.triangles.resize(2);  // a face
  mesh.parts.front().triangle_count = 2;
  const Built face = build(mesh);
  ASSERT_NE(face.mesh.flags[0] & kTriangleSheet, 0);
  EXPECT_EQ(face.winding_at({0.5, 0.5, 0.1}), 0);
}

}  // namespace
}  // namespace palpate

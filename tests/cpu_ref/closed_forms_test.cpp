// `refined` against closed forms: the truth is V / A, the volume that the tool has in common with the half space over its
// section with the surface. Block and tools are made of triangles; where they are round, the polyhedron's own V and A are
// the truth, so that what is measured is the method and not the tessellation.
#include <cmath>
#include <cstdio>
#include <functional>
#include <vector>

#include "model/generate/solids.h"
#include "tests/cpu_ref/bench_scene.h"

namespace palpate {
namespace {

constexpr double kPi = 3.14159265358979323846;
constexpr double kMm = 1e-3;

/// What a contact with the plane z = 0 should be.
struct Truth {
  double depth = 0;   // m, V / A
  Vec3 point{0};      // m, the section's centre, weighted by depth
};

/// The block's top face is the plane z = 0, far larger than any contact here: twelve triangles, or finer.
Mesh block(int cells = 1) {
  return solids::box(Vec3(-60 * kMm, -60 * kMm, -50 * kMm), Vec3(60 * kMm, 60 * kMm, 0), Int3(cells, cells, 1));
}

/// V, A and ∫ h·(x, y) dA below z = 0 of a closed mesh that is convex, moved: each triangle, clipped at z = 0, stands on a
/// prism up to the plane. Downward-facing parts count plus, upward-facing minus, so only the section remains.
Truth truth_of(const Mesh& mesh, const Pose& pose) {
  double volume = 0, area = 0;
  Vec3 moment(0);
  for (const auto& triangle : mesh.triangles) {
    std::vector<Vec3> polygon, kept;
    for (const std::uint32_t v : triangle) polygon.push_back(pose.rotation * mesh.vertices[v] + pose.position);
    for (std::size_t i = 0; i < polygon.size(); ++i) {
      const Vec3 &a = polygon[i], &b = polygon[(i + 1) % polygon.size()];
      if (a.z <= 0) kept.push_back(a);
      if ((a.z < 0) != (b.z < 0)) kept.push_back(a + (b - a) * (a.z / (a.z - b.z)));
    }
    for (std::size_t i = 1; i + 1 < kept.size(); ++i) {
      const Vec3 &a = kept[0], &b = kept[i], &c = kept[i + 1];
      const double projected = -0.5 * glm::cross(b - a, c - a).z;   // plus where the face looks down
      area += projected;
      volume += projected * -(a.z + b.z + c.z) / 3;
      // ∫ −z·x over a triangle: exact for a product of two linear functions.
      const auto product = [&](int k) {
        const double sum_k = a[k] + b[k] + c[k], sum_z = a.z + b.z + c.z;
        return -(sum_k * sum_z + a[k] * a.z + b[k] * b.z + c[k] * c.z) / 12 * projected;
      };
      moment += Vec3(product(0), product(1), 0);
    }
  }
  return {volume / area, moment / volume};
}

struct Case {
  const char* name;
  Mesh tool;
  std::function<Pose(double)> pose;     // of the depth of the tool's lowest point, m
  std::vector<double> depths;           // m
};

/// A spread of places relative to the grid of samples, chosen so that no symmetry helps.
Vec3 place(int i) { return Vec3(3.171 * i - 7.3, 2.339 * i - 5.1, 0) * kMm; }

/// The largest errors over places and depths, for one sample spacing.
struct Errors {
  double depth = 0;        // relative
  double normal_deg = 0;
  double point = 0;        // m
  double force = 0;        // relative
};

Errors errors_of(const Case& c, double spacing, Profile profile = Profile::kRefined, int cells = 1) {
  GeometrySettings settings;
  settings.voxel_size_m = 2 * kMm;
  settings.sample_spacing_m = spacing;
  BenchScene scene(block(cells), c.tool, settings, profile);
  Errors worst;
  double sum = 0;
  int count = 0;
  for (const double depth : c.depths)
    for (int i = 0; i < 5; ++i) {
      Pose pose = c.pose(depth);
      pose.position += place(i);
      const ContactResponse& answer = scene.ask(pose);
      const Truth truth = truth_of(c.tool, pose);
      if (answer.areas.size() != 1) {
        ADD_FAILURE() << c.name << ": " << answer.areas.size() << " areas";
        continue;
      }
      const AreaResponse& area = answer.areas[0];
      const double error = area.depth / truth.depth - 1;
      sum += error * error;
      ++count;
      worst.depth = std::max(worst.depth, std::fabs(error));
      worst.normal_deg = std::max(worst.normal_deg, angle_deg(area.normal, Vec3(0, 0, 1)));
      const Vec3 off = area.point - truth.point;
      worst.point = std::max(worst.point, std::hypot(off.x, off.y));
      const Vec3 force = BenchScene::kStiffness * truth.depth * Vec3(0, 0, 1);
      worst.force = std::max(worst.force, glm::length(answer.wrench.force - force) / glm::length(force));
    }
  std::printf("%-9s %s spacing %5.3f mm: d rms %.4f %%, max %.3f %%, n_c %.4f deg, cp %.4f mm, F %.3f %%\n", c.name, profile == Profile::kPaper ? "paper" : "refined", spacing / kMm,
              100 * std::sqrt(sum / count), 100 * worst.depth, worst.normal_deg, worst.point / kMm, 100 * worst.force);
  worst.depth = std::sqrt(sum / count);   // what the order is read from: less of a lottery than the largest
  return worst;
}

/// Asks at three spacings and expects the error of d to fall by at least `order` in the exponent.
void expect_convergence(const Case& c, double least_order, double finest_depth_error) {
  const Errors coarse = errors_of(c, 0.4 * kMm), middle = errors_of(c, 0.2 * kMm), fine = errors_of(c, 0.1 * kMm);
  const double order = std::log2(coarse.depth / fine.depth) / 2;
  std::printf("%-9s order of d: %.2f\n", c.name, order);
  EXPECT_GE(order, least_order);
  EXPECT_LT(fine.depth, finest_depth_error);
  EXPECT_LT(fine.point, middle.point + 1e-6);   // 1 µm: the point may already be at rounding
  EXPECT_LT(fine.normal_deg, 1e-5);             // one face: the plane's own normal
}

Case sphere() {
  const double r = 10 * kMm;
  return {"sphere", solids::sphere_of(r, 20000), [r](double h) { return Pose{Vec3(0, 0, r - h), Quat(1, 0, 0, 0)}; }, {1 * kMm, 2 * kMm}};
}

TEST(ClosedForms, ASpheresTruthIsTheCaps) {
  // The polyhedron's V / A against V = πh²(3R − h)/3 over π(2Rh − h²): 20,000 triangles leave 0.2 %.
  const Case c = sphere();
  for (const double h : c.depths) {
    const double r = 10 * kMm;
    const double expected = kPi * h * h * (3 * r - h) / 3 / (kPi * (2 * r * h - h * h));
    EXPECT_NEAR(truth_of(c.tool, c.pose(h)).depth / expected, 1, 2e-3);
  }
}

TEST(ClosedForms, ASphereInAPlaneConverges) { expect_convergence(sphere(), 1.0, 0.003); }

TEST(ClosedForms, ACylinderLyingInAPlaneConverges) {
  // Radius 8 mm, 20 mm long, turned by 21° about z so that its section is not along the grid.
  const Quat lying = glm::angleAxis(0.37, Vec3(0, 0, 1)) * glm::angleAxis(kPi / 2, Vec3(1, 0, 0));
  const Case c{"cylinder", solids::moved(solids::cylinder(8 * kMm, 20 * kMm, 400), Pose{Vec3(0, 0, -10 * kMm), Quat(1, 0, 0, 0)}),
               [lying](double h) { return Pose{Vec3(0, 0, 8 * kMm - h), lying}; }, {1 * kMm, 2 * kMm}};
  expect_convergence(c, 1.0, 0.003);
}

TEST(ClosedForms, ABoxCornerInAPlaneConverges) {
  // A cube on its corner: a pyramid, V / A = h / 3 whatever the tilt.
  const Quat on_corner = glm::angleAxis(0.61, Vec3(0, 0, 1)) * glm::angleAxis(std::atan(std::sqrt(2.0)), glm::normalize(Vec3(1, -1, 0)));
  const double half = 10 * kMm, reach = half * std::sqrt(3.0);
  const Case c{"corner", solids::box(Vec3(-half), Vec3(half)), [=](double h) { return Pose{Vec3(0, 0, reach - h), on_corner}; }, {2 * kMm, 4 * kMm}};
  EXPECT_NEAR(truth_of(c.tool, c.pose(3 * kMm)).depth, 1 * kMm, 1e-9);
  expect_convergence(c, 1.0, 0.01);
}

TEST(ClosedForms, PaperKeepsItsBias) {
  // Its samples are centroids and its candidates lie in voxels that the tool's surface touches. On twelve triangles none is
  // near; on a top face of 28,800 they are as dense as the coarsest samples above, and the middle of the contact is lost
  // where it is deeper than a voxel.
  EXPECT_GT(errors_of(sphere(), 0.4 * kMm, Profile::kPaper).depth, 0.5);
  Case c = sphere();
  c.depths = {0.5 * kMm};
  std::printf("a quarter of a voxel deep, 28,800 triangles:\n");
  EXPECT_LT(errors_of(c, 0.4 * kMm, Profile::kPaper, 120).depth, 0.05);
  c.depths = {4 * kMm};
  std::printf("two voxels deep, 28,800 triangles:\n");
  EXPECT_GT(errors_of(c, 0.4 * kMm, Profile::kPaper, 120).depth, 0.3);
}

TEST(ClosedForms, ATwentyMillimetreSphereAtTheDefaultSpacingIsWithinFivePercent) {
  // Both readings of "20 mm": radius and diameter. Twelve triangles, everything on auto.
  for (const double r : {10 * kMm, 20 * kMm}) {
    BenchScene scene(block(), solids::sphere_of(r, 8000));
    double worst = 0, worst_angle = 0;
    for (const double h : {0.5, 1.0, 2.0, 3.0, 4.0})
      for (int i = 0; i < 5; ++i) {
        const ContactResponse& answer = scene.ask(place(i) + Vec3(0, 0, r - h * kMm));
        ASSERT_EQ(answer.areas.size(), 1u);
        const double d = kPi * h * h * kMm * kMm * (3 * r - h * kMm) / 3 / (kPi * (2 * r * h * kMm - h * h * kMm * kMm));
        worst = std::max(worst, std::fabs(answer.areas[0].depth / d - 1));
        worst_angle = std::max(worst_angle, angle_deg(answer.areas[0].normal, Vec3(0, 0, 1)));
      }
    std::printf("sphere of radius %.0f mm, voxel %.3f mm, spacing %.3f mm: d within %.2f %%, n_c within %.4f deg\n", r / kMm,
                scene.voxel() / kMm, scene.spacing() / kMm, 100 * worst, worst_angle);
    EXPECT_LT(worst, 0.05);
    EXPECT_LT(worst_angle, 0.5);
  }
}

}  // namespace
}  // namespace palpate

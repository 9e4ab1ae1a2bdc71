// Small bodies whose contacts are simple to see, also where points, edges and faces coincide.
#include <gtest/gtest.h>

#include "model/generate/solids.h"
#include "tests/equivalence/equivalence_case.h"
#include "tests/equivalence/touching_poses.h"

namespace palpate {
namespace {

LatticePose near(const SceneGeometry& geometry, std::mt19937_64& random) { return random_touching_pose(geometry, 1.0, random); }
LatticePose deep(const SceneGeometry& geometry, std::mt19937_64& random) { return random_touching_pose(geometry, 4.0, random); }

/// Anywhere in the mock-up's box.
LatticePose inside(const SceneGeometry& geometry, std::mt19937_64& random) {
  LatticePose pose = random_touching_pose(geometry, 0.0, random);
  for (int k = 0; k < 3; ++k)
    pose.translation[k] = std::uniform_int_distribution<int>(geometry.mockup.box_min[k], geometry.mockup.box_max[k])(random);
  return pose;
}

Mesh big_box() { return solids::box({-0.05, -0.05, -0.02}, {0.05, 0.05, 0.0}); }
Mesh small_box() { return solids::box({-0.01, -0.01, -0.01}, {0.01, 0.01, 0.01}); }
Mesh ball() { return solids::sphere(0.02, 24, 12); }

/// A mesh with some triangles taken out: open.
Mesh without_every(Mesh mesh, std::size_t n) {
  std::size_t i = 0;
  std::erase_if(mesh.triangles, [&](const auto&) { return i++ % n == 0; });
  mesh.parts[0].triangle_count = static_cast<std::uint32_t>(mesh.triangles.size());
  return mesh;
}

Mesh square_sheet() {
  Mesh mesh;
  mesh.vertices = {{-0.03, -0.03, 0}, {0.03, -0.03, 0}, {0.03, 0.03, 0}, {-0.03, 0.03, 0}};
  mesh.triangles = {{0, 1, 2}, {0, 2, 3}};
  mesh.parts = {{"sheet", 0, 2}};
  return mesh;
}

/// 17 x 17 posts, 1 mm wide, 3 mm apart: more areas than a frame holds, when all are touched.
Mesh posts() {
  Mesh mesh;
  for (int i = -8; i <= 8; ++i)
    for (int j = -8; j <= 8; ++j)
      solids::append(mesh, solids::box(Vec3(i, j, 0) * 0.003, Vec3(i, j, 0) * 0.003 + Vec3(0.001, 0.001, 0.003)), "post");
  return mesh;
}

/// Flat on the posts, turned about z by quarters, somewhere over them.
LatticePose on_posts(const SceneGeometry& geometry, std::mt19937_64& random) {
  LatticePose pose = random_touching_pose(geometry, 0.0, random);
  for (int r = 0; r < 3; ++r)
    for (int c = 0; c < 3; ++c) pose.rotation_q30[r][c] = r == c ? 1 << 30 : 0;
  const int reach = (geometry.mockup.box_max.x - geometry.mockup.box_min.x) / 2;
  pose.translation = {std::uniform_int_distribution<int>(-reach, reach)(random) / static_cast<int>(1 + random() % 16), 0, geometry.mockup.box_max.z - geometry.tool.box_min.z - reach / 50};
  return pose;
}

class SolidsEquivalence : public testing::TestWithParam<EquivalenceCase> {};
TEST_P(SolidsEquivalence, BothBackEndsGiveTheSameIntegers) { expect_equal_answers(GetParam()); }

const GeometrySettings four_mm = {.voxel_size_m = 0.004, .sample_spacing_m = {}, .smooth_angle_deg = 30, .centre_of_mass_m = {}};

const GeometrySettings four_mm_coarse = {.voxel_size_m = 0.004, .sample_spacing_m = 0.001, .smooth_angle_deg = 30, .centre_of_mass_m = {}};

/// The tool on the mock-up it is a copy of, exactly, or moved by a step or two.
LatticePose near_identity(const SceneGeometry&, std::mt19937_64& random) {
  LatticePose pose;
  for (int k = 0; k < 3; ++k) {
    pose.rotation_q30[k][k] = 1 << 30;
    pose.translation[k] = static_cast<int>(random() % 3) - 1;
  }
  return pose;
}

INSTANTIATE_TEST_SUITE_P(
    All, SolidsEquivalence,
    testing::Values(
        EquivalenceCase{.name = "ball_on_block", .mockup = big_box, .tool = ball, .settings = four_mm, .pose = near},
        EquivalenceCase{.name = "ball_deep_in_block", .mockup = big_box, .tool = ball, .settings = four_mm, .pose = deep},
        EquivalenceCase{.name = "ball_on_block_paper", .mockup = big_box, .tool = ball, .settings = four_mm, .profile = Profile::kPaper, .pose = near},
        EquivalenceCase{.name = "boxes_aligned", .mockup = big_box, .tool = small_box, .settings = four_mm, .pose = aligned_touching_pose},
        EquivalenceCase{.name = "boxes_aligned_paper", .mockup = big_box, .tool = small_box, .settings = four_mm, .profile = Profile::kPaper, .pose = aligned_touching_pose},
        EquivalenceCase{.name = "cells_aligned", .mockup = [] { return solids::box({-0.04, -0.04, -0.02}, {0.04, 0.04, 0.02}, {8, 8, 4}); },
                        .tool = [] { return solids::box({-0.02, -0.02, -0.01}, {0.02, 0.02, 0.01}, {4, 4, 2}); }, .settings = four_mm, .pose = aligned_touching_pose},
        EquivalenceCase{.name = "ball_deep_in_fine_cells", .mockup = [] { return solids::box({-0.02, -0.02, -0.02}, {0.02, 0.02, 0.0}, {60, 60, 1}); },
                        .tool = ball, .settings = four_mm, .poses = 40, .pose = deep},
        EquivalenceCase{.name = "ball_held", .mockup = big_box, .tool = ball, .settings = four_mm, .held = true, .pose = near},
        EquivalenceCase{.name = "box_held", .mockup = [] { return solids::torus(0.04, 0.01, 32, 16); }, .tool = small_box, .settings = four_mm, .held = true, .pose = near},
        EquivalenceCase{.name = "box_swallowed", .mockup = big_box, .tool = [] { return solids::box({-0.003, -0.002, -0.002}, {0.003, 0.002, 0.002}); },
                        .settings = four_mm, .held = true, .pose = inside},
        EquivalenceCase{.name = "too_many_areas", .mockup = posts, .tool = [] { return solids::box({-0.03, -0.03, -0.004}, {0.03, 0.03, 0.004}); },
                        .settings = four_mm_coarse, .poses = 24, .pose = on_posts},
        EquivalenceCase{.name = "same_body_in_the_same_place", .mockup = [] { return solids::torus(0.04, 0.01, 24, 12); },
                        .tool = [] { return solids::torus(0.04, 0.01, 24, 12); }, .settings = four_mm, .poses = 8, .pose = near_identity},
        EquivalenceCase{.name = "needle", .mockup = big_box, .tool = [] { return solids::box({-0.0001, -0.0001, -0.01}, {0.0001, 0.0001, 0.01}); }, .settings = four_mm, .pose = near},
        EquivalenceCase{.name = "ball_through_plate", .mockup = [] { return solids::box({-0.05, -0.05, -0.001}, {0.05, 0.05, 0.0}); }, .tool = ball, .settings = four_mm, .held = true, .pose = deep},
        EquivalenceCase{.name = "open_ball", .mockup = big_box, .tool = [] { return without_every(ball(), 7); }, .settings = four_mm, .pose = near},
        EquivalenceCase{.name = "sheet_tool", .mockup = big_box, .tool = square_sheet, .settings = four_mm, .pose = near},
        EquivalenceCase{.name = "ball_on_sheet", .mockup = square_sheet, .tool = ball, .settings = four_mm, .held = true, .pose = near},
        EquivalenceCase{.name = "ball_on_open_torus", .mockup = [] { return without_every(solids::torus(0.04, 0.01, 32, 16), 5); }, .tool = ball, .settings = four_mm, .pose = near}),
    [](const auto& made) { return made.param.name; });

}  // namespace
}  // namespace palpate

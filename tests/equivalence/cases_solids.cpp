// Small bodies whose contacts are simple to see, and every rule of directions and heights among them.
#include "model/generate/solids.h"
#include "tests/equivalence/case.h"
#include "tests/equivalence/mesh_scene.h"
#include "tests/equivalence/touching_poses.h"

namespace palpate::equivalence {
namespace {

LatticePose near(const SceneGeometry& geometry, Random& random, Known&) {
  return random_touching_pose(geometry, 0.5, random);
}
LatticePose deep(const SceneGeometry& geometry, Random& random, Known&) {
  return random_touching_pose(geometry, 1.5, random);
}
LatticePose aligned(const SceneGeometry& geometry, Random& random, Known&) {
  return aligned_touching_pose(geometry, random);
}

/// Anywhere in the mock-up's box.
LatticePose inside(const SceneGeometry& geometry, Random& random, Known&) {
  LatticePose pose = random_touching_pose(geometry, 0.0, random);
  for (int k = 0; k < 3; ++k)
    pose.translation[k] = random.between(geometry.mockup.box_min[k], geometry.mockup.box_max[k]);
  return pose;
}

/// The tool on the mock-up it is a copy of, exactly, or moved by a step.
LatticePose near_identity(const SceneGeometry&, Random& random, Known&) {
  LatticePose pose;
  for (int k = 0; k < 3; ++k) {
    pose.rotation_q30[k][k] = 1 << 30;
    pose.translation[k] = random.between(-1, 1);
  }
  return pose;
}

/// Flat on the posts, somewhere over them.
LatticePose on_posts(const SceneGeometry& geometry, Random& random, Known&) {
  LatticePose pose;
  for (int k = 0; k < 3; ++k) pose.rotation_q30[k][k] = 1 << 30;
  const int reach = (geometry.mockup.box_max.x - geometry.mockup.box_min.x) / 2;
  const int along = random.between(
      -reach,
      reach);  // one number after the other: compilers take those of an expression in the order they like
  pose.translation = {along / random.between(1, 16), 0,
                      geometry.mockup.box_max.z - geometry.tool.box_min.z - reach / 50};
  return pose;
}

Mesh big_box() { return solids::box({-0.03, -0.03, -0.02}, {0.03, 0.03, 0.0}); }
Mesh small_box() { return solids::box({-0.01, -0.01, -0.01}, {0.01, 0.01, 0.01}); }
Mesh ball() { return solids::sphere(0.012, 12, 6); }
Mesh ring() { return solids::torus(0.02, 0.007, 20, 10); }
Mesh plate(double thickness) { return solids::box({-0.03, -0.03, -thickness}, {0.03, 0.03, 0.0}); }

/// A mesh with every n-th triangle taken out: open.
Mesh without_every(Mesh mesh, std::size_t n) {
  std::size_t i = 0;
  std::erase_if(mesh.triangles, [&](const auto&) { return i++ % n == 0; });
  mesh.parts[0].triangle_count = static_cast<std::uint32_t>(mesh.triangles.size());
  return mesh;
}

Mesh square_sheet() {
  Mesh mesh;
  mesh.vertices = {{-0.02, -0.02, 0}, {0.02, -0.02, 0}, {0.02, 0.02, 0}, {-0.02, 0.02, 0}};
  mesh.triangles = {{0, 1, 2}, {0, 2, 3}};
  mesh.parts = {{"sheet", 0, 2}};
  return mesh;
}

/// n × n posts, 1 mm wide, 3 mm apart.
Mesh posts(int n) {
  Mesh mesh;
  for (int i = 0; i < n; ++i)
    for (int j = 0; j < n; ++j) {
      const Vec3 corner = Vec3(i - n / 2, j - n / 2, 0) * 0.003;
      solids::append(mesh, solids::box(corner, corner + Vec3(0.001, 0.001, 0.003)), "post");
    }
  return mesh;
}

/// Two blocks side by side, and one on top of both with seams where their edges differ: seam rules and
/// several zones.
Mesh blocks_with_seams() {
  Mesh mesh;
  solids::append(mesh, solids::box({-0.03, -0.02, -0.01}, {0.0, 0.02, 0.0}, {2, 3, 1}), "left");
  solids::append(mesh, solids::box({0.0, -0.02, -0.01}, {0.03, 0.02, 0.0}, {3, 2, 1}), "right");
  return mesh;
}

constexpr GeometrySettings voxels(double voxel_m, double spacing_m) {
  GeometrySettings settings;
  settings.voxel_size_m = voxel_m;
  settings.sample_spacing_m = spacing_m;
  return settings;
}
const GeometrySettings kCoarse = voxels(0.004, 0.002);

using Pose = std::function<LatticePose(const SceneGeometry&, Random&, Known&)>;

Case solid(const char* name, const char* about, std::function<Mesh()> mockup, std::function<Mesh()> tool,
           Pose pose, GeometrySettings settings = kCoarse) {
  Case c;
  c.name = name;
  c.family = "solids";
  c.about = about;
  c.share = 0.16;  // some 8 ms a pose on lavapipe, asked twice, where a touch takes 2 ms
  c.make = [=](std::uint64_t) { return mesh_scene(mockup(), tool(), settings, pose); };
  return c;
}
Case ignoring(Case c) {
  c.name += "_ignoring";
  c.ignoring = true;
  return c;
}
Case killer(Case c) {
  c.killer = true;
  return c;
}
Case shared(Case c, double share, int poses) {
  c.share *= share;
  c.poses = poses;
  return c;
}

}  // namespace

std::vector<Case> solid_cases() {
  const Case ball_on_block =
      solid("ball_on_block", "one area on a flat face, or on an edge between two zones", big_box, ball, near);
  const Case deep_in_block =
      solid("ball_deep_in_block", "EST, IMT and no crossing beside them", big_box, ball, deep);
  const Case boxes = solid("boxes_aligned", "faces on faces, edges in faces, a step above or below", big_box,
                           small_box, aligned);
  const Case ball_on_ring =
      solid("ball_on_ring", "a curved, smooth mock-up, one or two areas", ring, ball, near);
  const Case through_plate = solid(
      "ball_through_plate",
      "a plate thinner than a sample's spacing: pierced areas, of which one gives force",
      [] { return plate(0.001); }, ball, deep);
  const Case on_sheet =
      solid("ball_on_sheet", "a mock-up without inside: the side is the tool's, or the one it had",
            square_sheet, ball, near);
  return {
      killer(ball_on_block),
      killer(ignoring(ball_on_block)),
      killer(paper(ball_on_block)),
      deep_in_block,
      killer(coarser(deep_in_block)),
      killer(all_samples(deep_in_block)),
      killer(boxes),
      paper(boxes),
      shared(solid(
                 "cells_aligned", "vertices on vertices, edges on edges of equal grids",
                 [] {
                   return solids::box({-0.02, -0.02, -0.01}, {0.02, 0.02, 0.01}, {5, 5, 3});
                 },
                 [] {
                   return solids::box({-0.008, -0.008, -0.004}, {0.008, 0.008, 0.004}, {2, 2, 1});
                 },
                 aligned),
             0.5, 24),
      shared(solid(
                 "ball_deep_in_fine_cells", "triangles smaller than a sample's spacing: EST by first corners",
                 [] {
                   return solids::box({-0.02, -0.02, -0.02}, {0.02, 0.02, 0.0}, {40, 40, 1});
                 },
                 ball, deep),
             0.2, 8),
      ball_on_ring,
      paper(ball_on_ring),
      ignoring(solid("box_in_ring", "several areas at once, each with what it held", ring, small_box, near)),
      killer(ignoring(solid(
          "box_swallowed", "a tool wholly inside, with and without a direction to remember", big_box,
          [] {
            return solids::box({-0.003, -0.002, -0.002}, {0.003, 0.002, 0.002});
          },
          inside, voxels(0.002, 0.001)))),
      shared(solid(
                 "too_many_areas", "more areas than a frame holds: both say so", [] { return posts(17); },
                 [] {
                   return solids::box({-0.026, -0.026, -0.004}, {0.026, 0.026, 0.004});
                 },
                 on_posts, voxels(0.004, 0.001)),
             0.02, 4),
      shared(killer(solid(
                 "many_areas", "nine posts: some areas, some zones", [] { return posts(3); },
                 [] {
                   return solids::box({-0.004, -0.004, -0.002}, {0.004, 0.004, 0.002});
                 },
                 on_posts, voxels(0.002, 0.0005))),
             0.5, 12),
      shared(killer(ignoring(solid(
                 "hundred_areas", "more areas than a workgroup has invocations, each with what it held",
                 [] { return posts(11); },
                 [] {
                   return solids::box({-0.017, -0.017, -0.003}, {0.017, 0.017, 0.003});
                 },
                 on_posts, voxels(0.003, 0.0005)))),
             0.02, 6),
      shared(solid(
                 "same_body_in_the_same_place", "all triangles coplanar with their own copies",
                 [] { return solids::torus(0.02, 0.007, 12, 8); },
                 [] { return solids::torus(0.02, 0.007, 12, 8); }, near_identity),
             0.05, 6),
      solid("box_in_its_own_place", "faces, edges and corners on their own copies", small_box, small_box,
            near_identity),
      killer(paper(solid("box_in_its_own_place",
                         "all normals cancel and no rule is left: no direction, no force", small_box,
                         small_box, near_identity))),
      killer(solid(
          "needle", "a tool thinner than the samples' spacing: heights of pairs and of tool vertices",
          big_box,
          [] {
            return solids::box({-0.0001, -0.0001, -0.01}, {0.0001, 0.0001, 0.01});
          },
          near)),
      killer(ignoring(through_plate)),
      through_plate,
      killer(solid(
          "open_ball", "a tool with holes that still has an inside", big_box,
          [] { return without_every(ball(), 7); }, near)),
      shared(killer(solid(
                 "open_fine_ball",
                 "the same of many triangles, of which rays may meet some in each of several clusters",
                 big_box, [] { return without_every(solids::sphere(0.012, 24, 12), 7); }, near)),
             0.5, 8),
      killer(solid("sheet_tool", "a tool without inside: tool_open", big_box, square_sheet, near)),
      killer(ignoring(on_sheet)),
      on_sheet,
      solid(
          "ball_on_open_ring", "a mock-up with holes", [] { return without_every(ring(), 5); }, ball, near),
      killer(solid("ball_on_seams", "faces that touch without sharing edges: seams, found in preparation",
                   blocks_with_seams, ball, near)),
      killer(solid(
          "ball_over_bead", "static normals that cancel: the tool's, or the way out",
          [] { return solids::sphere_of(0.004, 60); }, small_box, near, voxels(0.002, 0.001))),
      paper(solid(
          "bead_in_ball", "normals that cancel in the chapter's rule",
          [] { return solids::sphere_of(0.004, 60); }, ball, near)),
  };
}

}  // namespace palpate::equivalence

// Parts in their place: pegs, press fits, keys, rings and plates, a little off and a little tilted, where the
// field cancels in all but the last bits.
#include <algorithm>
#include <cmath>

#include "model/generate/solids.h"
#include "model/lattice/pose.h"
#include "tests/equivalence/case.h"
#include "tests/equivalence/mesh_scene.h"

namespace palpate::equivalence {
namespace {

constexpr double kMm = 1e-3;

Mesh block(const Vec3& min, const Vec3& max) { return solids::box(min * kMm, max * kMm); }
Mesh lifted(Mesh mesh, const Vec3& by) {
  return solids::moved(std::move(mesh), {by * kMm, Quat(1, 0, 0, 0)});
}
Mesh peg(double radius, double length, std::uint32_t sides) {
  return lifted(solids::cylinder(radius * kMm, length * kMm, sides, 4), {0, 0, -length / 2});
}
Mesh bore(double radius, double depth, std::uint32_t sides) {
  return lifted(solids::ring(radius * kMm, 2 * radius * kMm, depth * kMm, sides), {0, 0, -depth / 2});
}

Mesh cone(double radius, double height, std::uint32_t sides) {
  return solids::cone(radius * kMm, height * kMm, sides);
}

Mesh joined(const std::vector<Mesh>& parts) {
  Mesh out;
  for (const Mesh& part : parts) solids::append(out, part, "part");
  return out;
}

/// Walls round a square hole.
Mesh frame(double half) {
  return joined({block({-2 * half, half, -5}, {2 * half, 2 * half, 5}),
                 block({-2 * half, -2 * half, -5}, {2 * half, -half, 5}),
                 block({half, -half, -5}, {2 * half, half, 5}),
                 block({-2 * half, -half, -5}, {-half, half, 5})});
}

Mesh pads(int n) {
  std::vector<Mesh> all;
  for (int i = 0; i < n; ++i) {
    const double x = 16 * (i % 2) - 8, y = 16 * (i / 2) - 8;
    all.push_back(block({x - 3, y - 3, -5}, {x + 3, y + 3, 0}));
  }
  return joined(all);
}

/// Ridges along y with their edges up.
Mesh ridges(int n) {
  std::vector<Mesh> all;
  const double eighth = 3.14159265358979323846 / 8;  // half of the angle by which a box stands on its edge
  for (int i = 0; i < n; ++i)
    all.push_back(solids::moved(
        block({-2, -12, -2}, {2, 12, 2}),
        {Vec3(6 * i - 3 * (n - 1), 0, 0) * kMm, Quat(std::cos(eighth), 0, std::sin(eighth), 0)}));
  return joined(all);
}

/// The last triangle is missing.
Mesh nearly_closed(Mesh mesh) {
  mesh.triangles.pop_back();
  --mesh.parts.back().triangle_count;
  return mesh;
}

/// Two balls through each other, without some of their triangles: voxels doubt what their neighbours say.
Mesh doubted_balls(double radius) {
  Mesh balls =
      joined({solids::sphere(radius * kMm, 24, 16),
              lifted(solids::sphere(0.75 * radius * kMm, 24, 16), {0.45 * radius, 0.1 * radius, 0})});
  std::vector<std::array<std::uint32_t, 3>> left;
  for (std::size_t i = 0; i < balls.triangles.size(); ++i)
    if (i % 61 != 1) left.push_back(balls.triangles[i]);
  balls.triangles = std::move(left);
  balls.parts = {{"balls", 0, static_cast<std::uint32_t>(balls.triangles.size())}};
  return balls;
}

Mesh without_lid() {
  Mesh open = block({-6.2, -6.2, -6.2}, {6.2, 6.2, 12});
  std::erase_if(open.triangles, [&](const auto& t) {
    return std::all_of(t.begin(), t.end(), [&](std::uint32_t v) { return open.vertices[v].z > 11 * kMm; });
  });
  open.parts = {{"open", 0, static_cast<std::uint32_t>(open.triangles.size())}};
  return open;
}

Mesh sheet(double half) {
  Mesh mesh;
  const double h = half * kMm;
  mesh.vertices = {{-h, -h, 0}, {h, -h, 0}, {h, h, 0}, {-h, h, 0}};
  mesh.triangles = {{0, 1, 2}, {0, 2, 3}};
  mesh.parts = {{"sheet", 0, 2}};
  return mesh;
}

/// By how much a pose may be off its place: mm along each axis, and radians.
struct Off {
  Vec3 place{0};
  double along = 0.2, turn = 0.01;
};

Case fit(const char* name, const char* about, std::function<Mesh()> mockup, std::function<Mesh()> tool,
         Off off, double voxel = 2) {
  Case c;
  c.name = name;
  c.family = "fits";
  c.about = about;
  c.share = 0.1;  // as solids
  c.poses = 12;
  c.make = [=](std::uint64_t) {
    GeometrySettings settings;
    settings.voxel_size_m = voxel * kMm;
    settings.sample_spacing_m = voxel / 2 * kMm;
    return mesh_scene(
        mockup(), tool(), settings, [off](const SceneGeometry& geometry, Random& random, Known&) {
          Pose pose;
          double turn[3];
          for (int k = 0; k < 3; ++k)
            pose.position[k] = (off.place[k] + off.along * (2 * random.unit() - 1)) * kMm;
          for (double& t : turn) t = off.turn / 2 * (2 * random.unit() - 1);
          pose.rotation = Quat(1, turn[0], turn[1], turn[2]) *
                          (1 / std::sqrt(1 + turn[0] * turn[0] + turn[1] * turn[1] + turn[2] * turn[2]));
          return *to_lattice(pose, geometry);  // far within the lattice
        });
  };
  return c;
}

}  // namespace

std::vector<Case> fit_cases() {
  const Mesh thin_plate = block({-12, -12, -0.4}, {12, 12, 0});
  return {
      fit(
          "peg_with_play", "a round peg off its hole's middle and tilted", [] { return bore(10.05, 12, 24); },
          [] { return peg(10, 30, 24); }, {.along = 0.1}),
      fit(
          "fine_peg_with_play", "the same with small facets", [] { return bore(10.3, 12, 96); },
          [] { return peg(10, 30, 96); }, {.along = 0.4}),
      fit(
          "press_fit", "interference all round: the field cancels", [] { return bore(9.9, 12, 48); },
          [] { return peg(10, 30, 48); }, {.along = 0.05, .turn = 0.002}),
      fit(
          "nominal_fit", "equal cylinders, equal facets: faces on faces", [] { return bore(10, 12, 32); },
          [] { return peg(10, 30, 32); }, {.along = 0.001, .turn = 0}),
      fit(
          "two_tessellations", "equal cylinders, other facets: overlaps along them",
          [] { return bore(10, 12, 24); }, [] { return peg(10, 30, 40); }, {.along = 0.02, .turn = 0.2}),
      fit(
          "square_peg_yawed", "four edges at four walls", [] { return frame(8.1); },
          [] {
            return block({-8, -8, -12}, {8, 8, 12});
          },
          {.turn = 0.1}),
      fit(
          "square_peg_in_the_corner", "two walls at once", [] { return frame(8.5); },
          [] {
            return block({-8, -8, -12}, {8, 8, 12});
          },
          {.place = {0.6, 0.6, 0}, .along = 0.1, .turn = 0.001}),
      fit(
          "key_in_its_keyway", "three walls",
          [] {
            return joined({block({-10, 2.05, -4}, {10, 8, 4}), block({-10, -8, -4}, {10, -2.05, 4}),
                           block({-10, -2.05, -4}, {10, 2.05, -2})});
          },
          [] {
            return block({-6, -2, -2}, {6, 2, 3});
          },
          {.along = 0.1, .turn = 0.04}),
      fit(
          "tongue_between_walls", "pushed from both sides",
          [] {
            return joined({block({-10, 1.9, -5}, {10, 6, 5}), block({-10, -6, -5}, {10, -1.9, 5})});
          },
          [] {
            return block({-6, -2, -4}, {6, 2, 9});
          },
          {.along = 0.3}),
      fit(
          "ring_on_a_shaft", "the tool is outside", [] { return peg(10, 40, 48); },
          [] { return bore(10.1, 8, 48); }, {.along = 0.2, .turn = 0.05}),
      fit(
          "shaft_in_two_bearings", "two contacts far apart",
          [] {
            return joined({lifted(bore(5.05, 6, 32), {0, 0, -20}), lifted(bore(5.05, 6, 32), {0, 0, 20})});
          },
          [] { return peg(5, 60, 32); }, {.along = 0.1, .turn = 0.01}),
      fit(
          "bracket_with_a_near_leg", "a block in an inner corner, a leg close by",
          [] {
            return joined({block({-10, -10, -4}, {10, 10, 0}), block({-10, -10, 0}, {-6, 10, 12})});
          },
          [] {
            return block({-3, -4, 0}, {4, 4, 8});
          },
          {.place = {-3.1, 0, -0.1}, .along = 0.2}),
      fit(
          "plate_on_four_pads", "four equal contacts", [] { return pads(4); },
          [] {
            return block({-12, -12, 0}, {12, 12, 4});
          },
          {.place = {0, 0, -0.1}, .along = 0.15, .turn = 0.005}),
      fit(
          "plate_on_six_ridges", "six contacts along edges", [] { return ridges(6); },
          [] {
            return block({-18, -9, 0}, {18, 9, 4});
          },
          {.place = {0, 0, 2.7}, .along = 0.15}),
      fit(
          "box_off_a_table", "half over the edge",
          [] {
            return block({-20, -20, -8}, {0, 20, 0});
          },
          [] {
            return block({-6, -6, 0}, {6, 6, 8});
          },
          {.place = {0, 0, -0.2}, .along = 0.3}),
      fit(
          "thin_plate_pressed", "a wall of a fifth of a voxel, pierced now and then",
          [thin_plate] { return thin_plate; }, [] { return solids::sphere(6 * kMm, 20, 10); },
          {.place = {0, 0, 5.6}, .along = 0.6}),
      fit(
          "thin_tool_on_a_block", "the tool is the thin one",
          [] {
            return block({-12, -12, -10}, {12, 12, 0});
          },
          [thin_plate] { return thin_plate; }, {.along = 0.4, .turn = 0.05}),
      fit(
          "thin_tool_through_a_thin_plate", "two thin pieces, of which each says half",
          [thin_plate] { return thin_plate; },
          [] {
            return block({-5, -0.3, -4}, {5, 0.3, 4});
          },
          {.along = 4, .turn = 0.3}),
      fit(
          "pin_on_a_plate", "a contact narrower than a sample's spacing",
          [] {
            return block({-12, -12, -4}, {12, 12, 0});
          },
          [] {
            return lifted(peg(0.3, 12, 8), {0, 0, 6});
          },
          {.along = 0.3, .turn = 0.1}),
      fit(
          "cone_on_a_plate", "a tip, whose own samples alone say how it is pushed",
          [] {
            return block({-12, -12, -4}, {12, 12, 0});
          },
          [] { return cone(4, 10, 40); }, {.place = {0, 0, -1}, .along = 0.6, .turn = 0.3}),
      fit(
          "tip_to_tip", "two tips, of which each says half", [] { return cone(4, 10, 24); },
          [] {
            return solids::moved(cone(2, 8, 5), {Vec3(0), Quat(0, 1, 0, 0)});  // upside down
          },
          {.place = {0, 0, 1.5}, .along = 0.5, .turn = 0.2}),
      fit(
          "nearly_closed_shell", "an inside by vote",
          [] {
            return nearly_closed(block({-12, -12, -10}, {12, 12, 0}));
          },
          [] { return solids::sphere(5 * kMm, 16, 8); }, {.place = {0, 0, 4}, .along = 2, .turn = 1}),
      fit(
          "nearly_closed_ball_on_a_plates_edge", "extra samples about a tool whose inside is voted",
          [thin_plate] { return thin_plate; }, [] { return nearly_closed(solids::sphere(6 * kMm, 24, 12)); },
          {.place = {11, 0, 0}, .along = 2, .turn = 0.5}),
      fit(
          "thin_split_tool", "no voxel of the tool is wholly inside, and its faces do not meet",
          [] {
            return block({-12, -12, -10}, {12, 12, 0});
          },
          [thin_plate] { return solids::split(thin_plate, 1e-3); }, {.along = 0.4, .turn = 0.05}),
      fit(
          "split_sleeve_on_a_shaft", "the same round a shaft",
          [] { return solids::cylinder(8 * kMm, 30 * kMm, 24); },
          [] { return solids::split(solids::ring(8.1 * kMm, 8.9 * kMm, 12 * kMm, 24), 1e-3); },
          {.place = {0, 0, 8}, .along = 0.5, .turn = 0.05}),
      fit(
          "box_without_lid_round_a_block", "a tool that bounds nothing pushes as a sheet does",
          [] {
            return block({-6, -6, -6}, {6, 6, 6});
          },
          [] { return without_lid(); }, {.along = 0.6, .turn = 0.02}),
      fit(
          "block_in_a_box_without_lid", "a mock-up that bounds nothing pushes as a sheet does",
          [] { return without_lid(); },
          [] {
            return block({-6, -6, -6}, {6, 6, 6});
          },
          {.along = 0.6, .turn = 0.02}),
      fit(
          "block_in_doubted_balls", "weights ramp down where voxels of the mock-up doubt that it is inside",
          [] { return doubted_balls(12); },
          [] {
            return block({-5, -4, -4}, {5, 4, 4});
          },
          {.place = {8, 0, 0}, .along = 6, .turn = 1}, 1),
      fit(
          "doubted_balls_on_a_plates_edge", "the same of the tool", [thin_plate] { return thin_plate; },
          [] { return doubted_balls(12); }, {.place = {11, 0, 0}, .along = 8, .turn = 1}, 1),
      fit(
          "block_through_a_sheet", "no inside on either side of a surface", [] { return sheet(12); },
          [] {
            return block({-4, -4, -4}, {4, 4, 4});
          },
          {.along = 4.5, .turn = 1}),
      fit(
          "swallowed_by_a_ball", "nothing crosses", [] { return solids::sphere(14 * kMm, 24, 12); },
          [] { return solids::sphere(4 * kMm, 12, 6); }, {.along = 8, .turn = 1}),
  };
}

}  // namespace palpate::equivalence

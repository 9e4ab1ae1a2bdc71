// More of the family `rules`: what shaders do at the end of a list, a table or a row, and rules that only
// areas of odd shapes come to. Found by tests/mutation, as those of cases_rules.cpp.
#include <array>
#include <cmath>
#include <cstddef>
#include <utility>
#include <vector>

#include "model/generate/solids.h"
#include "tests/equivalence/case.h"
#include "tests/equivalence/lattice_shapes.h"
#include "tests/equivalence/rule_case.h"
#include "tests/equivalence/touching_poses.h"

namespace palpate::equivalence {
namespace {

constexpr std::int32_t kTimes = 64;  // of a large_rule

/// A rule of bodies, voxels and poses that are 64 times as large: what culls rays has a margin of a thousand
/// steps.
Case large_rule(const char* name, const char* about, Triangles mockup, Triangles tool, const PoseOf& pose,
                std::int32_t spacing = kTimes * kVoxel / 2) {
  for (Triangles* body : {&mockup, &tool})
    for (LatticeTriangle& t : *body) t = {kTimes * t.a, kTimes * t.b, kTimes * t.c};
  Case c = rule(name, about, {}, {}, {});
  c.make = [=](std::uint64_t) -> Result<TestScene> {
    auto geometry = lattice_scene(mockup, tool, kTimes * kVoxel, spacing);
    if (!geometry) return geometry.error();
    TestScene scene;
    scene.geometry = std::move(*geometry);
    scene.pose = [pose](const SceneGeometry& of, Random& random, Known& known) {
      LatticePose at = pose(of, random, known);
      at.translation = kTimes * at.translation;
      return at;
    };
    return scene;
  };
  return c;
}

/// Two cones base to base, 2·`rim` triangles, all of them in one voxel: every contact has all of them. No
/// sample is on it.
Triangles bud(int rim) {
  const Int3 centre(37, 41, 33);
  const auto at = [&](int i) {
    const Turn turn = turn_by(static_cast<double>(i % rim) / rim);
    return centre + Int3(static_cast<std::int32_t>(turn.cos * 3e4) / 2500,
                         static_cast<std::int32_t>(turn.sin * 3e4) / 2500, -8);
  };
  Triangles out;
  for (int i = 0; i < rim; ++i)
    append(out, {{centre, at(i), at(i + 1)}, {centre - Int3(0, 0, 20), at(i + 1), at(i)}});
  return out;
}

Case needle_in_a_bud(int rim) {
  return rule(
      rim == 32 ? "needle_in_a_bud" : "needle_in_a_large_bud",
      rim == 32 ? "a needle's area of as many triangles as a workgroup has invocations"
                : "the same of more triangles: what a vertex leaves is among the last",
      bud(rim), box_of(Int3(-1, -2, -30), Int3(2, 1, 30)), [](const SceneGeometry&, Random& random, Known&) {
        LatticePose pose = leaning(random, {37 + random.between(-4, 4), 41 + random.between(-4, 4), 33});
        pose.translation.z += random.between(-34, 24);
        return pose;
      });
}

/// A needle of short pieces: where the table meets it between two, more of its corners are near than
/// elsewhere.
Case needle_of_pieces() {
  Triangles needle;
  const Mesh mesh = solids::box(Vec3(-1, -2, -300), Vec3(2, 1, 300), {1, 1, 20});
  const auto at = [&](std::uint32_t vertex) { return Int3(glm::round(mesh.vertices[vertex])); };
  for (const auto& t : mesh.triangles) needle.push_back({at(t[0]), at(t[1]), at(t[2])});
  return rule("needle_of_pieces",
              "a needle of which now more corners are asked for their heights, and now fewer", block(),
              needle, [](const SceneGeometry&, Random& random, Known&) {
                return unturned({32 * random.between(-10, 10) + 9, 32 * random.between(-10, 10) + 11,
                                 512 + 15 * random.between(-12, 12)});
              });
}

/// A needle with a wide foot behind a thin plate: rays from its sides pass free voxels before they meet the
/// foot.
Case needle_with_a_foot() {
  return rule("needle_with_a_foot", "rays that cross nothing until they have passed free voxels",
              box_of(Int3(-512, -512, -32), Int3(512, 512, 0)),
              together({box_of(Int3(-1, -2, -200), Int3(2, 1, 300)),
                        box_of(Int3(-400, -400, -660), Int3(400, 400, -500))}),
              [](const SceneGeometry&, Random& random, Known&) {
                const Turn turn = turn_by((random.unit() - 0.5) / 16);
                LatticePose pose =
                    unturned({random.between(-90, 90), random.between(-90, 90), random.between(-150, 100)});
                if (random.below(4) == 0) return pose;
                pose.rotation_q30[1][1] = pose.rotation_q30[2][2] =
                    static_cast<std::int32_t>(turn.cos * 0x1p30);
                pose.rotation_q30[2][1] = static_cast<std::int32_t>(turn.sin * 0x1p30);
                pose.rotation_q30[1][2] = -pose.rotation_q30[2][1];
                return pose;
              });
}

/// The tool's own origin is the centre of a V_ext voxel, while all of the tool is in V_int: there is no way
/// out of where it is.
Case swallowed_round_a_cavity() {
  Triangles mockup = block();
  append(mockup, flipped(box_of(Int3(32 - 160), Int3(32 + 160))));
  return rule(
      "swallowed_round_a_cavity",
      "wholly inside, on both sides of a cavity: the nearest V_ext voxel is where the tool's origin is",
      mockup,
      together(
          {box_of(Int3(-320, -20, -20), Int3(-280, 20, 20)), box_of(Int3(280, -20, -20), Int3(320, 20, 20))}),
      [](const SceneGeometry&, Random& random, Known& known) {
        known.pairs.emplace();
        known.contact = true;
        return unturned(Int3(32) + (random.below(3) == 0 ? Int3(0) : any(random, 1)));
      });
}

/// The tool is far from its own origin, which lies above the corner of the grid that is first in a row of
/// bricks.
Case swallowed_from_afar() {
  return rule("swallowed_from_afar", "wholly inside, with the tool's origin beyond the grid", block(),
              box_of(Int3(480, 480, -1900), Int3(520, 520, -1860)),
              [](const SceneGeometry&, Random& random, Known& known) {
                known.pairs.emplace();
                known.contact = true;
                return unturned(Int3(-500, -500, 1900) + any(random, 120));
              });
}

/// Pairs of triangles folded along an edge: their normals cancel, and neither they nor the tool that runs
/// through them has a sample.
Triangles folds(int n) {
  Triangles out;
  for (int i = 0; i < n; ++i) {
    const Int3 p(64 * i + 4, 1, -20), q(64 * i + 24, 1, -20);
    append(out, {{p, q, {64 * i + 14, 1, 20}}, {q, p, {64 * i + 17, 1, 22}}});
  }
  return out;
}

Case folds_in_a_row() {
  return rule(
      "folds_in_a_row",
      "more areas than a workgroup has invocations, all of which ask for the way out, and are needles",
      folds(70), box_of(Int3(-2300, 5, 3), Int3(2300, 25, 9)),
      [](const SceneGeometry&, Random& random, Known&) {
        return unturned({2240 + (random.below(2) == 0 ? 0 : random.between(-900, 900)),
                         random.between(-22, -6), random.between(-20, 8)});
      });
}

Case too_many_folds() {
  Triangles all;  // 16 rows of 18
  for (int j = 0; j < 16; ++j)
    for (LatticeTriangle t : folds(18)) {
      for (Int3* corner : {&t.a, &t.b, &t.c}) corner->y += 64 * j;
      all.push_back(t);
    }
  Case c =
      rule("too_many_folds", "a few areas more than a frame holds, or as many, or fewer", all,
           box_of(Int3(-576, -600, 3), Int3(576, 600, 9)), [](const SceneGeometry&, Random& random, Known&) {
             return unturned(
                 {576 + 64 * (random.below(2) == 0 ? 2 : random.between(0, 3)), 500, random.between(-14, 4)});
           });
  c.poses = 6;
  c.share = 0.02;
  return c;
}

/// A bead all of whose edges are smooth, as far on one side of its centre as on the other, corner by corner.
Triangles smooth_bead(std::int32_t radius) {
  constexpr int kRings = 14, kSegments = 28;
  const auto at = [&](int ring, int segment) {
    const Turn up = turn_by(0.5 * ring / kRings),
               round = turn_by(static_cast<double>(segment % kSegments) / kSegments);
    const auto scaled = [&](double x) { return static_cast<std::int32_t>(std::lround(x * radius)); };
    return Int3(scaled(up.sin * round.cos), scaled(up.sin * round.sin), scaled(up.cos));
  };
  Triangles half;
  for (int i = 0; i < kRings / 2; ++i)
    for (int j = 0; j < kSegments; ++j) {
      const Int3 a = at(i, j), b = at(i + 1, j), c = at(i + 1, j + 1), d = at(i, j + 1);
      if (i > 0) half.push_back({a, b, d});
      half.push_back({d, b, c});
    }
  Triangles all = half;
  for (const LatticeTriangle& t : half) all.push_back({-t.a, -t.c, -t.b});
  return all;
}

/// The bead is inside the tool, but for a voxel of it that one side of the tool passes through.
Case smooth_bead_in_a_tool() {
  return rule("smooth_bead_in_a_tool", "an area of one zone whose normals cancel, while the tool's do not",
              smooth_bead(100), box_of(Int3(-300), Int3(300)),
              [](const SceneGeometry&, Random& random, Known&) {
                Int3 at = any(random, 40);
                const int side = random.below(2) == 0 ? 1 : -1, off = random.between(101, 127);
                at[random.between(0, 2)] = side * (300 - off);
                return unturned(at);
              });
}

/// Plates with three corners, and a pole through each of two of them near one: what its rays leave is there,
/// and far from all others.
Case pierced_near_corners() {
  Triangles plates;
  for (int i = 0; i < 3; ++i) {
    const Int3 off(1500 * i, 0, 0), down(0, 0, -32);
    const std::array<Int3, 3> of = {off + Int3(0, 300, 0), off + Int3(1200, 0, 0), off + Int3(500, 1200, 0)};
    const auto corner = [&](int k) { return of[static_cast<std::size_t>((k + i) % 3)]; };
    append(plates,
           {{corner(0), corner(1), corner(2)}, {corner(0) + down, corner(2) + down, corner(1) + down}});
    for (int k = 0; k < 3; ++k)
      append(plates, {{corner(k), corner(k) + down, corner(k + 1)},
                      {corner(k + 1), corner(k) + down, corner(k + 1) + down}});
  }
  Case c = large_rule(
      "pierced_near_corners",
      "a pole near each corner of a plate: the back that it pierces is near that corner alone", plates,
      together({box_of(Int3(-40, -40, -250), Int3(40, 40, 250)),
                box_of(Int3(1460, -40, -250), Int3(1540, 40, 250))}),
      [](const SceneGeometry&, Random& random, Known&) {
        constexpr std::array<std::array<std::int32_t, 2>, 3> kNear = {{{377, 433}, {886, 248}, {538, 802}}};
        const auto& [x, y] = kNear[random.below(3)];
        LatticePose pose = unturned({1500 * random.between(0, 1) + x, y, -16 + random.between(-100, 100)});
        if (random.below(2) == 0) pose.rotation_q30[1][1] = pose.rotation_q30[2][2] = -(1 << 30);
        return pose;
      });
  c.poses = 36;
  return c;
}

/// Two backs that cross in a line, too steeply to be one area, and only rays that leave both of them there.
Case crossed_backs() {
  const auto sheet = [](std::int32_t left, std::int32_t right) {
    const Int3 p(-200, -512, left), q(200, -512, right), r(200, 512, right), s(-200, 512, left);
    return Triangles{{p, r, q}, {p, s, r}};  // seen from below
  };
  return rule(
      "crossed_backs", "rays that leave two other areas at one height",
      together({side_of(Int3(-512, -512, -1), Int3(512, 512, 0), 5), sheet(-180, -20), sheet(-20, -180)}),
      box_of(Int3(-20, -70, -250), Int3(20, 70, 250)), [](const SceneGeometry&, Random& random, Known&) {
        return unturned({random.between(-14, 14), random.between(-300, 300), 20 + random.between(-60, 160)});
      });
}

/// Parts of a tool above each other, the faces between them in the planes between its voxels: a gap too
/// narrow for a free voxel, and none at all.
Case stacked_tool(bool open) {
  Triangles tool =
      together({box_of(Int3(0, 0, 3), Int3(192, 192, 64)), box_of(Int3(0, 0, 70), Int3(192, 192, 128)),
                box_of(Int3(0, 0, 128), Int3(192, 192, 192)), box_of(Int3(0, 0, 198), Int3(192, 192, 256))});
  if (open)
    append(
        tool,
        together({box_of(Int3(320, 0, 0), Int3(640, 192, 256)),
                  {{Int3(230, 20, 100), Int3(270, 30, 90), Int3(240, 60, 130)}}}));  // with an inside; a fin
  Case c = rule(open ? "stacked_tool_open" : "stacked_tool",
                open ? "the same of a tool with a fin"
                     : "rays that leave a part of the tool and enter the next within a voxel, or where they "
                       "leave; at the very faces of voxels",
                block(), tool, [](const SceneGeometry&, Random& random, Known&) {
                  LatticePose pose = random.below(3) != 0 ? unturned(Int3(0)) : quarter_turns(random);
                  if (random.below(3) == 0)
                    pose = unturned(Int3(0)), pose.rotation_q30[1][1] = pose.rotation_q30[2][2] = -(1 << 30);
                  pose.translation = {random.between(-200, 200), random.between(-200, 200),
                                      512 + random.between(-220, 220)};
                  return pose;
                });
  c.poses = 24;
  return c;
}

/// Triangles too small for a sample. First corners on the first and on the last points of voxels, along each
/// axis.
Case between_the_samples() {
  Triangles all;
  for (int axis = 0; axis < 3; ++axis)
    for (const bool last : {false, true})
      for (int i = 0; i < 27; ++i) {
        const Int3 cell(i % 3 - 1, i / 3 % 3 - 1, i / 9 - 1);
        Int3 a = kVoxel * cell + Int3(7 + 6 * axis + (last ? 17 : 0), 8 + 5 * axis + (last ? 18 : 0),
                                      9 + 4 * axis + (last ? 19 : 0));
        const std::int32_t inwards = last && i % 2 == 0 ? -1 : 1;  // some reach into the next voxel, too
        a[axis] = kVoxel * cell[axis] + (last ? kVoxel - 1 : 0);
        Int3 b = a, c = a;
        b[axis] += 4 * inwards;
        b[(axis + 1) % 3] += 1;
        c[axis] += 2 * inwards;
        c[(axis + 2) % 3] += 3;
        all.push_back({a, b, c});
      }
  return rule("between_the_samples", "EST by first corners alone, on the faces of voxels", all, small_box(),
              [](const SceneGeometry&, Random& random, Known&) {
                LatticePose pose = random.below(2) == 0 ? unturned(Int3(0)) : quarter_turns(random);
                pose.translation = any(random, 90);
                return pose;
              });
}

/// Samples on the last row of points of a voxel: 63 is one of 64.
Case samples_on_last_rows() {
  return rule(
      "samples_on_last_rows",
      "a spacing that does not divide a voxel: rows of samples on the last points of one", block(),
      small_box(),
      [](const SceneGeometry&, Random& random, Known&) {
        const Int3 on[] = {{63, 63, 512}, {63 - 448, 63 + 448, 512}, {512, 63, 63}, {63, -512, 63 - 448}};
        const Int3 beside = any(random, 40);
        return unturned(on[random.below(4)] + beside);
      },
      {}, 7);
}

/// A triangle has 62² samples in a voxel, whose places take more steps together than llvmpipe lets one
/// invocation's loops have, were these not rolled out.
Case many_samples_of_a_voxel() {
  Case c = large_rule(
      "many_samples_of_a_voxel", "voxels of as many spacings as there may be", box_of(Int3(-64), Int3(64)),
      small_box(),
      [](const SceneGeometry&, Random& random, Known&) {
        LatticePose pose = leaning(random, Int3(0));
        pose.translation = Int3{random.between(-20, 20), random.between(-20, 20), random.between(70, 100)};
        return pose;
      },
      kTimes + 2);
  c.poses = 4;
  return c;
}

/// A box whose lower side along x, where rays along x begin, is bars with gaps narrower than a voxel: open,
/// and yet with an inside.
Case open_at_its_low_end() {
  Triangles tool = box_of(Int3(0, -128, -128), Int3(256, 128, 128));
  tool.erase(tool.begin(), tool.begin() + 2);
  for (std::int32_t z = -128; z < 128; z += 40)
    append(tool, side_of(Int3(0, -128, z), Int3(1, 128, z + 16), 0));
  return rule(
      "open_at_its_low_end",
      "samples in the plane where an open tool begins; turned, it has now more and now fewer wide triangles",
      block(), tool, [](const SceneGeometry& geometry, Random& random, Known&) {
        if (random.below(2) == 0) return random_touching_pose(geometry, 0.7, random);
        return unturned(
            {32 * random.between(-10, 10), random.between(-300, 300), 512 + random.between(-100, 100)});
      });
}

/// A regular tetrahedron, outward; all four sides meet the plane z = centre.
Triangles tetrahedron(const Int3& centre) {
  const Int3 p = centre + Int3(3, 3, 3), q = centre + Int3(3, -3, -3), r = centre + Int3(-3, 3, -3),
             s = centre + Int3(-3, -3, 3);
  return {{p, q, r}, {p, s, q}, {p, r, s}, {q, s, r}};
}

/// One part of the tool ends within a bead, another one holds a bead, and all is inside: as many triangles in
/// CST as in EST.
Case beads_in_balance() {
  return rule(
      "beads_in_balance",
      "wholly inside but for two beads: as many pairs' triangles as those inside the tool, and no sample",
      together({block(), tetrahedron(Int3(7, 9, 11)), tetrahedron(Int3(307, 9, 11))}),
      together(
          {box_of(Int3(-50, -50, -120), Int3(60, 60, 0)), box_of(Int3(220, -90, -90), Int3(390, 90, 90))}),
      [](const SceneGeometry&, Random& random, Known&) { return unturned(Int3(7, 9, 11) + any(random, 1)); });
}

/// Sheets side by side, each an area with a side to remember: a step further the tool meets one that it did
/// not meet before.
Case sheets_in_a_row() {
  Triangles sheets;
  for (int i = 0; i < 12; ++i)
    append(sheets, side_of(Int3(60 * i - 360, -200, -100), Int3(60 * i - 312, 200, 4 * (i % 3)), 5));
  Case c = ignoring(
      rule("sheets_in_a_row", "what is held of one sheet is not its neighbour's", sheets,
           box_of(Int3(-90, -60, -40), Int3(90, 60, 40)), [](const SceneGeometry&, Random& random, Known&) {
             return unturned({random.between(-250, 250), random.between(-100, 100), random.between(-30, 34)});
           }));
  c.poses = 2 * kChain;
  return c;
}

/// One sheet of many triangles between small ones, of which eight lie before it in any order but that of ids.
Case large_sheet_among_small() {
  Triangles sheets;
  for (int i = 0; i < 12; ++i)
    append(sheets, side_of(Int3(-36 + 6 * i, -60, -100), Int3(-30 + 6 * i, 60, 0), 5));
  for (int i = 0; i < 16; ++i) {
    const std::int32_t x = i < 8 ? -50 - 12 * i : 50 + 12 * (i - 8);
    append(sheets, side_of(Int3(x, -60, -100), Int3(x + 6, 60, 2 + i % 3), 5));
  }
  Case c = ignoring(rule(
      "large_sheet_among_small", "what is held of a large sheet is not the small one's before it", sheets,
      box_of(Int3(-160, -40, -30), Int3(170, 40, 30)), [](const SceneGeometry&, Random& random, Known&) {
        return unturned({random.between(-20, 20), random.between(-20, 20), random.between(-20, 24)});
      }));
  c.poses = 2 * kChain;
  return c;
}

/// Boxes and needles deep inside, in bricks that are V_int alone, or with some of them in the wall. A needle
/// has half a step of height: at some poses its corners are collinear.
Case deep_boxes_and_needles() {
  Triangles tool;
  for (int i = 0; i < 27; ++i) {
    const Int3 low = 300 * (Int3(i % 3, i / 3 % 3, i / 9) - 1);
    append(tool, box_of(low, low + 40 + i));
    const Int3 a = low + 150, b = a + Int3(25, 0, 0), c = a + Int3(50, 1, 0);
    if (i % 4 == 0) append(tool, {{a, b, c}, {a, c, b}});
  }
  // Where the search takes eight triangles at a time, some eights are of needles that lean to the axes and
  // begin with their shorter edge, some of triangles of a step.
  for (int i = 0; i < 16; ++i) {
    const Int3 a = Int3(620, 620, -620) + 5 * Int3(i % 4, i / 4, i % 3), b = a + Int3(25, 25, 0),
               c = a + Int3(50, 51, 0), p = Int3(-650, 640, 650) + Int3(0, 0, i);
    append(tool, {{a, b, c}, {c, b, a}});
    append(tool, {{p, p + Int3(1, 0, 0), p + Int3(0, 1, 0)}, {p, p + Int3(0, 1, 0), p + Int3(1, 0, 0)}});
  }
  Case out = rule(
      "deep_boxes_and_needles", "a tool deep inside: IMT by whole bricks, but for what is collinear",
      box_of(Int3(-2560), Int3(2560)), tool, [](const SceneGeometry& geometry, Random& random, Known& known) {
        LatticePose pose = random_touching_pose(geometry, 0.5, random);
        const bool wholly = random.below(3) != 0;
        pose.translation = any(random, wholly ? 900 : 2400);
        known.contact = true;
        if (wholly) known.pairs = Pairs{};
        return pose;
      });
  out.poses = 24;
  return out;
}

/// What is inside an open tool reaches out of its triangles, and out of their box: the mock-up's end is in
/// there and near nothing.
Case pole_in_an_open_cup() {
  Triangles tool = box_of(Int3(-900, -300, -300), Int3(-300, 300, 300)),
            cup = box_of(Int3(235, -55, -300), Int3(345, 55, 300));
  cup.resize(10);  // less its top
  append(tool, cup);
  return rule("pole_in_an_open_cup", "EST and samples inside an open tool, beyond its box",
              box_of(Int3(-20, -20, 0), Int3(20, 20, 2000)), tool,
              [](const SceneGeometry&, Random& random, Known& known) {
                known.pairs = Pairs{};
                const auto beside = [&] { return random.between(-25, 25); };  // 10 steps from the walls
                return unturned(Int3{beside() - 290, beside(), random.between(-400, 200)});
              });
}

/// A tool that is flat along x in its own frame: its box has no size there.
Case flat_tool() {
  return rule("flat_tool", "a sheet in a plane of y and z as the tool", block(),
              side_of(Int3(300, -300, -300), Int3(340, 300, 300), 0),
              [](const SceneGeometry& geometry, Random& random, Known&) {
                return random_touching_pose(geometry, 0.5, random);
              });
}

/// Plates on each other, one a voxel, so that all voxels hold some: in its middle no walk of the vote is
/// short. One lacks a side, so all is open.
Case heap_of_plates() {
  constexpr std::int32_t kHalf = 12 * kVoxel;
  Triangles heap = box_of(Int3(-kHalf, -kHalf, -kHalf), Int3(kHalf, kHalf, 3 * kVoxel / 8 - kHalf));
  heap.resize(10);
  for (std::int32_t z = kVoxel - kHalf; z < kHalf; z += kVoxel)
    append(heap, box_of(Int3(-kHalf, -kHalf, z), Int3(kHalf, kHalf, z + 3 * kVoxel / 8)));
  return rule("heap_of_plates",
              "samples in voxels of an open mock-up of which all walks of the vote are long", heap,
              box_of(Int3(-kVoxel, -kVoxel, -kVoxel), Int3(kVoxel, kVoxel, kVoxel)),
              [](const SceneGeometry&, Random& random, Known&) { return unturned(any(random, 2 * kVoxel)); });
}

}  // namespace

std::vector<Case> limit_cases() {
  return {needle_in_a_bud(32),
          needle_in_a_bud(50),
          needle_of_pieces(),
          needle_with_a_foot(),
          swallowed_round_a_cavity(),
          swallowed_from_afar(),
          folds_in_a_row(),
          too_many_folds(),
          smooth_bead_in_a_tool(),
          pierced_near_corners(),
          crossed_backs(),
          stacked_tool(false),
          stacked_tool(true),
          between_the_samples(),
          samples_on_last_rows(),
          many_samples_of_a_voxel(),
          open_at_its_low_end(),
          beads_in_balance(),
          sheets_in_a_row(),
          large_sheet_among_small(),
          deep_boxes_and_needles(),
          pole_in_an_open_cup(),
          flat_tool(),
          heap_of_plates()};
}

}  // namespace palpate::equivalence

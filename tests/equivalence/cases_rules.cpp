// Small scenes made for one rule each, most of them a tie or a corner of a rule that other families reach by
// chance or never: found by tests/mutation, where a changed operator went unseen.
#include "model/generate/solids.h"
#include "model/generate/turn.h"
#include "model/lattice/pose.h"
#include "tests/equivalence/case.h"
#include "tests/equivalence/lattice_shapes.h"
#include "tests/equivalence/rectangles.h"
#include "tests/equivalence/rule_case.h"
#include "tests/equivalence/touching_poses.h"

namespace palpate::equivalence {
namespace {

LatticePose anyhow(const SceneGeometry& geometry, Random& random, Known&) {
  return random.below(2) == 0 ? aligned_touching_pose(geometry, random)
                              : random_touching_pose(geometry, 0.5, random);
}

/// The top of a table in two halves: one edge of the left half lies along two of the right. Triangles that
/// touch along it share one corner at most, and only so are the halves one area.
Case seam_with_a_common_corner() {
  Triangles table = block();
  table.resize(10);  // without its top
  append(table, {{Int3(-512, -512, 512), Int3(0, -512, 512), Int3(0, 512, 512)},
                 {Int3(-512, -512, 512), Int3(0, 512, 512), Int3(-512, 512, 512)}});
  const Int3 ring[5] = {{0, -512, 512}, {512, -512, 512}, {512, 512, 512}, {0, 512, 512}, {0, 100, 512}};
  for (int i = 0; i < 5; ++i) append(table, {{Int3(300, 3, 512), ring[i], ring[(i + 1) % 5]}});
  return rule(
      "seam_with_a_common_corner", "a seam between triangles that share a corner and no edge: two areas",
      table, small_box(), [](const SceneGeometry&, Random& random, Known& known) {
        known.contact = true;
        known.areas = 2;
        return unturned({random.between(-30, 30), random.between(-200, 200), 512 + random.between(-20, 40)});
      });
}

/// Three triangles in a plane that touch only where no edge is shared: an area each.
Case seams_in_a_row() {
  const Triangles row = {{Int3(-20, -512, 0), Int3(-20, 512, 0), Int3(-512, 0, 0)},
                         {Int3(-20, -300, 0), Int3(20, 0, 0), Int3(-20, 300, 0)},
                         {Int3(20, 512, 0), Int3(20, -512, 0), Int3(512, 0, 0)}};
  return rule(
      "seams_in_a_row",
      "three triangles of which the second touches the first and the third, with no common edge: three areas",
      row, small_box(), [](const SceneGeometry&, Random& random, Known& known) {
        known.contact = true;
        known.areas = 3;
        return unturned({random.between(-15, 15), random.between(-30, 30), random.between(-38, 38)});
      });
}

/// Two sheets whose triangles are numbered in turn: a neighbour of the next triangle is no neighbour of this
/// one.
Case numbered_in_turn() {
  const Triangles sheets = {{Int3(-20, -512, 0), Int3(-20, 512, 0), Int3(-512, 0, 0)},
                            {Int3(20, 512, 0), Int3(20, -512, 0), Int3(512, 0, 0)},
                            {Int3(-20, -512, 0), Int3(-10, 0, 0), Int3(-20, 512, 0)}};
  return rule("numbered_in_turn", "two sheets whose triangles are numbered in turn: two areas", sheets,
              small_box(), [](const SceneGeometry&, Random& random, Known& known) {
                known.contact = true;
                known.areas = 2;
                return unturned({random.between(-15, 15), random.between(-30, 30), random.between(-38, 38)});
              });
}

/// A body between two copies of a convex outline in the plane of `axis` and z, at ±40 along the third axis.
Triangles prism(const std::vector<std::array<std::int32_t, 2>>& outline, int axis) {
  const auto corner = [&](std::size_t i, std::int32_t across) {
    Int3 p(0, 0, outline[i % outline.size()][1]);
    p[axis] = outline[i % outline.size()][0];
    p[1 - axis] = across;
    return p;
  };
  Triangles out;
  for (std::size_t i = 0; i < outline.size(); ++i) {
    append(out, {{corner(i, -40), corner(i + 1, -40), corner(i + 1, 40)},
                 {corner(i, -40), corner(i + 1, 40), corner(i, 40)}});
    if (i > 0 && i + 1 < outline.size())
      append(out, {{corner(0, -40), corner(i + 1, -40), corner(i, -40)},
                   {corner(0, 40), corner(i, 40), corner(i + 1, 40)}});
  }
  return out;
}

/// Two parts of a tool whose undersides cross in a line, over which samples lie: their rays leave both parts
/// at one height, and the smaller of two normals says how the samples fade in.
Case crossed_wedges(int axis, bool as_steep) {
  const Triangles tool = as_steep ? together({prism({{-40, -20}, {40, 20}, {40, 90}, {-40, 90}}, axis),
                                              prism({{-30, -20}, {30, 20}, {30, 80}, {-30, 80}}, axis)})
                                  : together({prism({{-40, -20}, {40, 20}, {40, 90}, {-40, 90}}, axis),
                                              prism({{-40, 10}, {40, -10}, {40, 80}, {-40, 80}}, axis)});
  return rule(as_steep    ? "crossed_wedges_one_y"
              : axis == 0 ? "crossed_wedges"
                          : "crossed_wedges_along_y",
              as_steep ? "the same where the two normals differ in z alone"
                       : "rays that leave a tool through two of its parts at one height",
              block(), tool, [](const SceneGeometry& geometry, Random& random, Known& known) {
                known.contact = true;
                const std::int32_t step = geometry.sample_spacing;
                const std::int32_t line = geometry.tool.box_min.z + 20;  // where the undersides cross
                return unturned({step * random.between(-5, 5), step * random.between(-5, 5),
                                 512 - line - random.between(1, 19)});
              });
}

/// Rays along an axis see a crossing from the last centre before it: here the only centre that is inside.
Case inside_of_one_voxel(bool low) {
  const Int3 min = low ? Int3(50) : Int3(10), max = min + Int3(2 * kVoxel);
  RectangleWorld classes;
  classes.add({min, max, 1});
  return rule(low ? "inside_of_one_voxel_low" : "inside_of_one_voxel",
              "a box of which one voxel alone is V_int", box_of(min, max), small_box(), anyhow, classes);
}

/// A box whose V_int voxels are one whole brick, and open, so that each of them casts three ballots.
Case inside_of_one_brick(bool open) {
  // The grid begins two voxels before the first box, so that the second's inside begins with a brick.
  Triangles all;
  RectangleWorld classes;
  for (const Int3& first : {Int3(0), Int3(13, 5, 5)}) {
    const Int3 min = Int3(10) + kVoxel * first, max = min + Int3(9 * kVoxel);
    append(all, box_of(min, max));
    classes.add({min, max, 1});
  }
  if (open) {  // a fin beside them
    const Int3 a = kVoxel * Int3(2, 12, 12) + Int3(5);
    append(all, {{a, a + Int3(0, 128, 0), a + Int3(0, 128, 128)},
                 {a, a + Int3(0, 128, 128), a + Int3(0, 0, 128)}});
    classes.add_sheet(a, a + Int3(0, 128, 128));
  }
  Case c =
      rule(open ? "inside_of_one_brick_open" : "inside_of_one_brick",
           "boxes one of which has a brick's voxels inside and no others", all, small_box(), anyhow, classes);
  c.poses = 4;
  return c;
}

/// Six sheets apart from each other shut a cube of voxels in. Towards +x two of them cancel, towards +z there
/// is one; towards +y a second one covers `half` of the rows or all. So two thirds, or half, of the ballots
/// are for V_ext.
Case votes(bool half) {
  constexpr std::int32_t kLow = -20, kHigh = 4 * kVoxel + 20, kIn = 4;
  const auto side = [&](int axis, bool upper, std::int32_t off, std::int32_t u_high) {
    Int3 min(kLow + kIn), max(kHigh - kIn);
    (upper ? max : min)[axis] = (upper ? kHigh : kLow) + off;
    if (upper)
      min[axis] = max[axis] - 100;
    else
      max[axis] = min[axis] + 100;
    if (u_high != 0) max[(axis + 2) % 3] = u_high;
    return side_of(min, max, static_cast<std::size_t>(2 * axis + (upper ? 1 : 0)));
  };
  Triangles all = together({side(0, false, 0, 0), side(0, true, 0, 0), side(1, false, 0, 0),
                            side(1, true, 0, 0), side(2, false, 0, 0), side(2, true, 0, 0),
                            flipped(side(0, true, 6, 0)), flipped(side(1, true, 6, half ? 2 * kVoxel : 0))});
  return rule(half ? "votes_tied" : "votes_in_minority",
              "an enclosed hollow that a third or half of its ballots hold for V_int: it is V_ext", all,
              small_box(), anyhow);
}

/// The tool's centre in the plane of a sheet: neither side is nearer.
Case sheet_through_gc() {
  return rule("sheet_through_gc",
              "the tool's centre of mass lies in the sheet's plane: the tie gives the sheet's own side",
              side_of(Int3(-512, -512, -100), Int3(512, 512, 0), 5), box_of(Int3(-100), Int3(100)),
              [](const SceneGeometry&, Random& random, Known&) {
                LatticePose pose = random.below(2) == 0 ? unturned(Int3(0)) : quarter_turns(random);
                pose.translation = {random.between(-300, 300), random.between(-300, 300),
                                    random.below(3) == 0 ? random.between(-1, 1) : 0};
                return pose;
              });
}

/// Two sheets, each with the side that the tool first had.
Case two_sheets() {
  return rule(
      "two_sheets", "a frame that meets a second sheet: what is held of the first is not the second's",
      together({side_of(Int3(-512, -512, -100), Int3(-20, 512, 0), 5),
                side_of(Int3(20, -512, -100), Int3(512, 512, 50), 5)}),
      box_of(Int3(-70), Int3(70)), [](const SceneGeometry&, Random& random, Known&) {
        return unturned({random.between(-100, 100), random.between(-300, 300), random.between(-60, 110)});
      });
}

/// All that is known of a bead in the tool's middle is the way out.
Case bead() {
  return rule("bead_in_the_middle", "normals that cancel, in chains: the direction held",
              box_of(Int3(-60, -50, -40), Int3(60, 50, 40)), box_of(Int3(-256), Int3(256)),
              [](const SceneGeometry&, Random& random, Known&) { return unturned(any(random, 120)); });
}

Triangles plate(std::int32_t top) { return box_of(Int3(-512, -512, top - 32), Int3(512, 512, top)); }

/// The tool ends in the back's own plane: its rays leave it where they meet the back.
Case flush_with_the_back() {
  return rule(
      "flush_with_the_back",
      "a tool that ends in a plate's back, a step before it or behind it: pierced only there", plate(0),
      box_of(Int3(-100, -100, 0), Int3(100, 100, 256)), [](const SceneGeometry&, Random& random, Known&) {
        return unturned({random.between(-300, 300), random.between(-300, 300), -32 + random.between(-1, 1)});
      });
}

Case two_plates() {
  return rule("two_plates",
              "a tool through two plates from either side: only the nearest back is pierced from a front",
              together({plate(0), plate(-100)}), box_of(Int3(-60, -60, -250), Int3(60, 60, 250)),
              [](const SceneGeometry&, Random& random, Known&) {
                LatticePose pose = unturned(Int3(0));
                if (random.below(2) == 0) pose.rotation_q30[1][1] = pose.rotation_q30[2][2] = -(1 << 30);
                pose.translation = {random.between(-300, 300), random.between(-300, 300),
                                    -60 + random.between(-160, 160)};
                return pose;
              });
}

/// A needle turned about x alone: its long edges run across y and z, and pass the table between lattice
/// points.
Case needle_leaning() {
  return rule(
      "needle_leaning", "a needle whose edges have one x: which end comes first is decided by y", block(),
      box_of(Int3(-1, -2, -300), Int3(2, 1, 300)), [](const SceneGeometry&, Random& random, Known&) {
        const Turn turn = turn_by((random.unit() - 0.5) / 4);  // up to an eighth of a turn
        LatticePose pose =
            unturned({random.between(-450, 450), random.between(-250, 250), 512 + random.between(-100, 200)});
        pose.rotation_q30[1][1] = pose.rotation_q30[2][2] = static_cast<std::int32_t>(turn.cos * 0x1p30);
        pose.rotation_q30[2][1] = static_cast<std::int32_t>(turn.sin * 0x1p30);
        pose.rotation_q30[1][2] = -pose.rotation_q30[2][1];
        return pose;
      });
}

/// The centroid of the one mobile triangle is as far from the large sheet's centre as that sheet's corner,
/// and close to the small sheet.
Case on_the_sphere() {
  const Triangles tool{{Int3(-120, -60, -60), Int3(120, -60, 0), Int3(0, 120, 60)}};
  return rule("on_the_sphere", "a mobile triangle's centroid on an area's sphere, or a step off it",
              together({side_of(Int3(-512, -512, -100), Int3(512, 512, 0), 5),
                        side_of(Int3(400, 400, -100), Int3(624, 624, 30), 5)}),
              tool, [](const SceneGeometry&, Random& random, Known&) {
                return unturned(Int3(512, 512, 0) + (random.below(2) == 0 ? Int3(0) : any(random, 1)));
              });
}

/// Two small sheets to the left and right of the centroid, as far from it.
Case between_two_areas() {
  const Triangles tool{{Int3(-400, -250, 0), Int3(400, -250, 0), Int3(0, 500, 0)}};
  return rule("between_two_areas", "a mobile triangle in no area's sphere and as near to one as to the other",
              together({side_of(Int3(-400, -32, -32), Int3(-300, 32, 32), 1),
                        side_of(Int3(200, -32, -32), Int3(300, 32, 32), 1)}),
              tool, [](const SceneGeometry&, Random& random, Known&) {
                return unturned({random.below(2) == 0 ? 0 : random.between(-1, 1),
                                 200 + random.between(-20, 20), random.between(-20, 20)});
              });
}

/// A clamp whose arms lie on either side of a rod, with a finger beside one and a long triangle that only
/// just reaches in. A ray may pass its own arm and meet another that is not in C_m, that is another area's,
/// that several spheres hold, or that none holds and is the nearest area's. `paper`.
Case clamp_round_a_rod() {
  Triangles
      rod;  // its upper and lower side in squares of 64 steps, so that some centroids are beside the arms
  for (std::int32_t x = -256; x < 256; x += 64)
    for (std::int32_t y = -128; y < 128; y += 64) {
      append(rod, side_of(Int3(x, y, -100), Int3(x + 64, y + 64, 100), 5));
      append(rod, side_of(Int3(x, y, -100), Int3(x + 64, y + 64, 100), 4));
    }
  const Triangles clamp = together({box_of(Int3(-40, -40, 90), Int3(40, 40, 300)),
                                    box_of(Int3(-100, -120, -300), Int3(200, 120, -90)),
                                    box_of(Int3(150, -30, 80), Int3(200, 30, 260)),
                                    {{Int3(-100, -80, 100), Int3(-100, 80, 100), Int3(-1500, 0, 20)}}});
  Case c = rule(
      "clamp_round_a_rod", "a ray that passes its own area's arm may meet another's: only its own counts",
      rod, clamp, [](const SceneGeometry&, Random& random, Known&) {
        const int z = random.between(-30, 30), y = random.between(-90, 90), x = random.between(-90, 90);
        const Int3 at(x, y, z);
        return random.below(3) == 0 ? unturned(at) : leaning(random, at);
      });
  c.poses = 24;
  return paper(c);
}

/// Wholly inside, at points from which several voxels are the nearest way out.
Case swallowed_at_ties() {
  return rule("swallowed_at_ties",
              "wholly inside, as far from one way out as from another: the voxel of the smallest number",
              block(), box_of(Int3(-20), Int3(20)), [](const SceneGeometry&, Random& random, Known& known) {
                known.pairs.emplace();
                known.contact = true;
                const Int3 beside = random.below(4) == 0 ? any(random, 1) : Int3(0);
                return unturned(kVoxel / 2 * any(random, 6) + beside);
              });
}

/// A tool with a hollow underneath, and one of two overlapping boxes: where the ray's winding first falls to
/// 0 is not the last crossing.
Case bridge() {
  return rule("bridge_and_overlap",
              "tools that rays leave and enter again, and one whose winding is 2 inside", block(),
              together({box_of(Int3(-200, -100, -100), Int3(-60, 100, 100)),
                        box_of(Int3(60, -100, -100), Int3(200, 100, 100)),
                        box_of(Int3(-220, -80, 60), Int3(220, 80, 200)),
                        box_of(Int3(-50, -50, 240), Int3(50, 50, 300))}),
              [](const SceneGeometry& geometry, Random& random, Known&) {
                if (random.below(3) == 0) return random_touching_pose(geometry, 0.5, random);
                LatticePose pose = random.below(2) == 0 ? unturned(Int3(0)) : quarter_turns(random);
                for (int k = 0; k < 3; ++k) pose.translation[k] = random.between(-300, 300);
                pose.translation[random.between(0, 2)] = 512 + random.between(-100, 100);
                return pose;
              });
}

/// A spindle along x through a sheet that faces along it: its radius is 0.96 · 2^27 steps, just what the
/// lattice has room for, and rays leave it along most of its length, through hundreds of its voxels.
Case long_tool() {
  constexpr std::int32_t kLong = 129'000'000, kWide = 2'200'000, kLargeVoxel = 1 << 20;
  Triangles spindle;
  const Mesh ball = solids::sphere(1, 12, 8);
  const auto stretched = [&](std::uint32_t vertex) {
    const Vec3& v = ball.vertices[vertex];
    return Int3(glm::round(Vec3(v.z * kLong, v.x * kWide, v.y * kWide)));
  };
  for (const auto& t : ball.triangles) spindle.push_back({stretched(t[0]), stretched(t[1]), stretched(t[2])});
  Case c =
      rule("long_tool", "a tool as large as the lattice has room for, and rays along most of it", {}, {}, {});
  c.make = [=](std::uint64_t) -> Result<TestScene> {
    auto geometry =
        lattice_scene(side_of(Int3(-100, -6'000'000, -6'000'000), Int3(0, 6'000'000, 6'000'000), 1), spindle,
                      kLargeVoxel, kLargeVoxel / 2);
    if (!geometry) return geometry.error();
    TestScene scene;
    scene.geometry = std::move(*geometry);
    scene.pose = [](const SceneGeometry& of, Random& random, Known&) {
      palpate::Pose tilted;  // its rotation alone is used
      const double turned = random.unit() * 6, z = random.unit() - 0.5, y = random.unit() - 0.5;
      tilted.rotation = rotation_about(Vec3(0, y, z) * 0.02) * rotation_about(Vec3(1, 0, 0), turned);
      LatticePose pose = to_lattice(tilted, of).value();
      pose.beyond_lattice = false;
      pose.translation = {random.between(-100'000'000, 100'000'000), random.between(-1'000'000, 1'000'000),
                          random.between(-1'000'000, 1'000'000)};
      return pose;
    };
    return scene;
  };
  return c;
}

/// Closed shells one in another: a ray from the middle crosses them all before its winding is 0.
enum class Nested {
  kClosed,
  kOpen,
  kOpenWithInside
};  // the last has whole voxels within its innermost shell
Case nested_tool(Nested kind) {
  Triangles tool;
  const std::int32_t first = kind == Nested::kOpenWithInside ? 100 : 40;
  for (std::int32_t half = first; half <= first + (first == 40 ? 68 : 36); half += 4)
    append(tool, box_of(Int3(-half), Int3(half)));
  if (kind != Nested::kClosed) tool.pop_back();
  return rule(kind == Nested::kClosed ? "nested_tool"
              : kind == Nested::kOpen ? "nested_tool_open"
                                      : "nested_tool_open_with_inside",
              first == 40 ? "eighteen shells one in another: rays with more crossings than are kept at once"
                          : "ten shells, open: rays look at the whole tool more than once",
              block(), tool, [](const SceneGeometry&, Random& random, Known&) {
                LatticePose pose = random.below(2) == 0 ? unturned(Int3(0)) : quarter_turns(random);
                pose.translation = {random.between(-300, 300), random.between(-300, 300),
                                    512 + random.between(-60, 100)};
                return pose;
              });
}

/// An open tool's points are judged by rays along x: here through small triangles and then large ones, from
/// points in planes of its faces.
Case open_box_and_boxes() {
  Triangles tool = box_of(Int3(0, -128, -128), Int3(256, 128, 128));
  tool.erase(tool.begin(), tool.begin() + 2);  // without its lower side along x
  for (std::int32_t i = 0; i < 8; ++i)
    append(tool, box_of(Int3(-160, 32 * i - 128, -32 * (i % 4)), Int3(-64, 32 * i - 104, 64 - 32 * (i % 4))));
  return rule("open_box_and_boxes",
              "an open tool with an inside: rays through many small triangles and few large ones, along "
              "faces and edges",
              block(), tool, [](const SceneGeometry& geometry, Random& random, Known&) {
                if (random.below(4) == 0) return random_touching_pose(geometry, 0.5, random);
                LatticePose pose = random.below(3) != 0 ? unturned(Int3(0)) : quarter_turns(random);
                pose.translation = 32 * any(random, 8) + Int3(0, 0, 512);
                if (random.below(2) == 0) pose.translation.z = 512 + random.between(-120, 120);
                return pose;
              });
}

/// A needle without one of its triangles; with a box far from the table, it still has an inside.
Case needle_open(bool with_inside) {
  Triangles tool = box_of(Int3(-1, -2, -300), Int3(2, 1, 300));
  tool.pop_back();
  if (with_inside) append(tool, box_of(Int3(-150, -150, 330), Int3(150, 150, 630)));
  return rule(with_inside ? "needle_open_with_inside" : "needle_open",
              "a needle with a hole: how its heights are found depends on whether the tool has an inside",
              block(), tool, [](const SceneGeometry&, Random& random, Known&) {
                return leaning(random, {random.between(-300, 300), random.between(-250, 250),
                                        512 + random.between(-100, 250)});
              });
}

/// What a needle's rays pierce, through surfaces of many triangles.
Case needle_through_plates() {
  return rule(
      "needle_through_plates", "a needle through two plates: its own samples look for what they pierce",
      together({plate(0), plate(-100)}), box_of(Int3(-1, -2, -250), Int3(2, 1, 250)),
      [](const SceneGeometry&, Random& random, Known&) {
        return leaning(
            random, {random.between(-300, 300), random.between(-300, 300), -60 + random.between(-200, 200)});
      });
}

/// The tip of a cone of more triangles than a workgroup has invocations.
Case needle_in_a_fan() {
  constexpr int kRim = 100;
  Triangles cone;
  const auto rim = [](int i) {
    const Turn turn = turn_by(static_cast<double>(i % kRim) / kRim);
    return Int3(static_cast<std::int32_t>(turn.cos * 512), static_cast<std::int32_t>(turn.sin * 512), -100);
  };
  for (int i = 0; i < kRim; ++i)
    append(cone, {{Int3(0), rim(i), rim(i + 1)}, {Int3(0, 0, -300), rim(i + 1), rim(i)}});
  return rule("needle_in_a_fan", "a needle in a cone's tip, where a hundred triangles meet", cone,
              box_of(Int3(-1, -2, -300), Int3(2, 1, 300)), [](const SceneGeometry&, Random& random, Known&) {
                LatticePose pose = leaning(random, any(random, 3));
                pose.translation.z = random.between(-250, 290);
                return pose;
              });
}

/// `n` by `n` cells a face.
Triangles fine_plate(std::int32_t top, std::uint32_t n) {
  Triangles out;
  const Mesh mesh = solids::box(Vec3(-512, -512, top - 32), Vec3(512, 512, top), {n, n, 1});
  const auto at = [&](std::uint32_t vertex) { return Int3(glm::round(mesh.vertices[vertex])); };
  for (const auto& t : mesh.triangles) out.push_back({at(t[0]), at(t[1]), at(t[2])});
  return out;
}

Case fine_plates() {
  return rule(
      "fine_plates",
      "the same through plates of many triangles: what a ray leaves is among the last of them, too",
      together({fine_plate(0, 8), fine_plate(-100, 8)}), box_of(Int3(-200, -200, -250), Int3(200, 200, 250)),
      [](const SceneGeometry&, Random& random, Known&) {
        LatticePose pose =
            unturned({random.between(-300, 300), random.between(-300, 300), -60 + random.between(-240, 240)});
        if (random.below(2) == 0) pose.rotation_q30[1][1] = pose.rotation_q30[2][2] = -(1 << 30);
        return pose;
      });
}

/// The top of the block ends with a brick of voxels: above it are whole bricks of V_ext, and of those the
/// nearest voxel is asked.
Case swallowed_below_a_brick() {
  return rule("swallowed_below_a_brick",
              "the nearest way out is in a brick that is V_ext as a whole, two or four of its voxels as near "
              "as each other",
              box_of(Int3(-512), Int3(512, 512, 352)), box_of(Int3(-20), Int3(20)),
              [](const SceneGeometry&, Random& random, Known& known) {
                known.pairs.emplace();
                known.contact = true;
                const Int3 beside = random.below(3) == 0 ? any(random, 1) : Int3(0),
                           at = kVoxel * any(random, 3) + beside;
                return unturned({at.x, at.y, 352 - 21 - random.between(0, 80)});
              });
}

/// Tubes of which one end is missing: two of three ballots say V_int, but each voxel reaches the border,
/// along the tube alone, from brick to brick. So a join that is forgotten shows; in a closed body the vote
/// would mend it.
Case open_tubes() {
  constexpr std::int32_t kLong = 21 * kVoxel, kWide = 3 * kVoxel;
  Triangles all;
  std::int32_t i = 0;
  for (int axis = 0; axis < 3; ++axis)
    for (const bool upper : {false, true}) {
      Int3 size(kWide);
      size[axis] = kLong;
      const Int3 min(700 * i, 500 * (i % 3) + 90, 300 * (i % 2) - 40);
      Triangles tube = box_of(min, min + size);
      tube.erase(tube.begin() + 4 * axis + (upper ? 2 : 0), tube.begin() + 4 * axis + (upper ? 4 : 2));
      append(all, tube);
      ++i;
    }
  // A bag as wide as three bricks: whole bricks of it are free.
  Triangles bag = box_of(Int3(-2000, -2000, -2000), Int3(-200, -200, -200));
  bag.erase(bag.begin() + 8, bag.begin() + 10);
  append(all, bag);
  Case c = rule("open_tubes",
                "tubes and a bag that are open at one end: V_ext reaches their insides from brick to brick "
                "along one axis",
                all, small_box(), anyhow);
  c.poses = 4;
  return c;
}

/// The mock-up is a block and a bead in it, which no sample is on.
Triangles block_with_bead() { return together({block(), box_of(Int3(-1, 1, 3), Int3(7, 9, 11))}); }

Case bead_in_a_swallowed_tool() {
  return rule("bead_in_a_swallowed_tool",
              "wholly inside, but for a bead in the tool that has no sample: EST and IMT, no pair",
              block_with_bead(), small_box(), [](const SceneGeometry&, Random& random, Known& known) {
                known.pairs.emplace();
                known.contact = true;
                return unturned(any(random, 20));
              });
}

Case bead_beside_a_swallowed_part() {
  return rule(
      "bead_beside_a_swallowed_part",
      "one part of the tool on a bead without samples, the other wholly inside: pairs and IMT, no sample",
      block_with_bead(), together({box_of(Int3(-3), Int3(3)), box_of(Int3(200, -3, -3), Int3(206, 3, 3))}),
      [](const SceneGeometry&, Random& random, Known&) { return unturned(Int3(3, 5, 7) + any(random, 5)); });
}

}  // namespace

std::vector<Case> rule_cases() {
  return {seam_with_a_common_corner(),
          inside_of_one_voxel(false),
          inside_of_one_voxel(true),
          inside_of_one_brick(false),
          inside_of_one_brick(true),
          votes(true),
          votes(false),
          sheet_through_gc(),
          ignoring(two_sheets()),
          ignoring(bead()),
          flush_with_the_back(),
          two_plates(),
          needle_leaning(),
          on_the_sphere(),
          between_two_areas(),
          swallowed_at_ties(),
          bridge(),
          long_tool(),
          seams_in_a_row(),
          numbered_in_turn(),
          crossed_wedges(0, false),
          crossed_wedges(1, false),
          crossed_wedges(1, true),
          nested_tool(Nested::kClosed),
          nested_tool(Nested::kOpen),
          nested_tool(Nested::kOpenWithInside),
          open_box_and_boxes(),
          needle_open(false),
          needle_open(true),
          needle_through_plates(),
          needle_in_a_fan(),
          fine_plates(),
          paper(two_sheets()),
          open_tubes(),
          swallowed_below_a_brick(),
          bead_in_a_swallowed_tool(),
          bead_beside_a_swallowed_part(),
          clamp_round_a_rod()};
}

}  // namespace palpate::equivalence

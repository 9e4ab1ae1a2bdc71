// Surfaces that are not a tidy solid's, made of boxes along the axes, so that the class of every voxel can be
// written down.
#include "model/generate/turn.h"
#include "tests/equivalence/case.h"
#include "tests/equivalence/lattice_shapes.h"
#include "tests/equivalence/rectangles.h"
#include "tests/equivalence/touching_poses.h"

namespace palpate::equivalence {
namespace {

constexpr std::int32_t kVoxel = 64;

/// A mock-up, its parts, and what is known of it.
struct Body {
  Triangles triangles;
  std::vector<std::size_t> parts;         ///< where each begins; empty: one
  std::optional<RectangleWorld> classes;  ///< what the class of every voxel follows from
  std::optional<std::size_t> areas;       ///< of the tool sunk into the table
  bool table = true;  ///< has the face z = 512 for |x|, |y| ≤ 128, nothing above it, and an inside below
};

Body of_boxes(std::initializer_list<WeightedBox> boxes, bool apart = false) {
  Body body;
  body.classes.emplace();
  for (const WeightedBox& box : boxes) {
    if (apart) body.parts.push_back(body.triangles.size());
    append(body.triangles, box_of(box.min, box.max));
    body.classes->add(box);
  }
  return body;
}

const WeightedBox kBlock{Int3(-512, -512, -512), Int3(512, 512, 512), 1};

/// Takes one triangle out of a box_of().
Body without_triangle(Body body, std::size_t triangle) {
  body.triangles.erase(body.triangles.begin() + static_cast<std::ptrdiff_t>(triangle));
  return body;
}

/// The block with a solid of winding 2 within, turned as given: an overlap of two closed parts.
Body nested() { return of_boxes({kBlock, {Int3(-200, -200, -333), Int3(200, 200, 128), 1}}, true); }

/// The block with a cavity: the inner shell faces inwards.
Body cavity() {
  Body body = of_boxes({kBlock});
  body.parts = {0, 12};
  const WeightedBox inner{Int3(-200, -200, -333), Int3(200, 200, 128), -1};
  append(body.triangles, flipped(box_of(inner.min, inner.max)));
  body.classes->add(inner);
  return body;
}

Body overlapping() { return of_boxes({kBlock, {Int3(0, -700, -600), Int3(700, 0, 300), 1}}, true); }

Body flipped_shell() {
  Body body = of_boxes({kBlock});
  body.triangles = flipped(body.triangles);  // import turns it round
  return body;
}

/// Without its bottom the inside is the outside.
Body open_box() {
  Body body = of_boxes({kBlock});
  body.triangles.erase(body.triangles.begin() + 8, body.triangles.begin() + 10);  // face 4: lower z
  body.classes->open(4);
  body.table = false;
  return body;
}

/// One of the bottom's two triangles is missing: the inside runs out through its half.
Body missing_triangle() {
  Body body = without_triangle(of_boxes({kBlock}), 8);
  body.classes->open_half(4);
  body.table = false;
  return body;
}

/// The top is a fan round its middle with a corner in the middle of one of its sides that the side's wall
/// does not have.
Body t_junction() {
  Body body = of_boxes({kBlock});
  body.triangles.resize(10);
  const Int3 ring[5] = {
      {-512, -512, 512}, {512, -512, 512}, {512, 100, 512}, {512, 512, 512}, {-512, 512, 512}};
  for (int i = 0; i < 5; ++i) body.triangles.push_back({Int3(7, 3, 512), ring[i], ring[(i + 1) % 5]});
  body.areas = 1;
  return body;
}

/// Two boxes that share one edge and nothing else: four triangles on it.
Body edge_of_four() { return of_boxes({kBlock, {Int3(512, 512, -512), Int3(900, 900, 512), 1}}); }

/// A fin on an edge of the block: three triangles on it. No ray from within meets it, for it stands beside.
Body edge_of_three() {
  Body body = of_boxes({kBlock});
  const Int3 a(-512, -512, -512), b(-512, -512, 512), c(-512, -900, 512), d(-512, -900, -512);
  append(body.triangles, {{a, b, c}, {a, c, d}});
  body.classes->add_sheet(Int3(-512, -900, -512), Int3(-512, -512, 512));
  return body;
}

/// Front and back of a plate in one plane; its rim has no area and takes no part.
Body zero_thickness() {
  Body body = of_boxes({{Int3(-512, -512, 512), Int3(512, 512, 512), 1}});
  body.table = false;
  return body;
}

Body duplicates(bool apart) {
  Body body = of_boxes({kBlock, kBlock}, apart);
  return body;
}
Body duplicate_triangle() {
  Body body = of_boxes({kBlock});
  body.triangles.push_back(body.triangles[10]);  // of the top
  return body;
}

/// Two blocks side by side with `gap` steps between them (negative: an overlap), the tool on both.
Body two_blocks(std::int32_t gap) {
  Body body = of_boxes(
      {{Int3(-512, -512, -512), Int3(0, 512, 512), 1}, {Int3(gap, -512, -512), Int3(600, 512, 512), 1}},
      true);
  body.areas = gap == 0 ? 1 : 2;  // faces side by side share an edge; faces that overlap do not
  return body;
}

/// Half an octahedron's faces and its three equators: one-sided, every edge of it with two triangles.
Body one_sided() {
  const std::int32_t r = 512;
  const Int3 e[6] = {{r, 0, 0}, {-r, 0, 0}, {0, r, 0}, {0, -r, 0}, {0, 0, r}, {0, 0, -r}};
  Body body;
  body.triangles = {{e[0], e[2], e[4]}, {e[0], e[3], e[5]}, {e[1], e[2], e[5]}, {e[1], e[3], e[4]},
                    {e[0], e[2], e[1]}, {e[0], e[1], e[3]}, {e[0], e[4], e[1]}, {e[0], e[1], e[5]},
                    {e[2], e[4], e[3]}, {e[2], e[3], e[5]}};
  body.table = false;
  return body;
}

/// A Klein bottle, the "figure 8" one: closed, one-sided, through itself.
Body klein_bottle() {
  constexpr int kAround = 20, kAcross = 10;
  const auto at = [](int i, int j) {
    if (i == kAround) i = 0, j = kAcross - j;  // half a turn: the far end is joined upside down
    const Turn u = turn_by(i / double{kAround}), half = turn_by(i / (2.0 * kAround)),
               v = turn_by(j / double{kAcross}), vv = turn_by(2 * j / double{kAcross});
    const double across = half.cos * v.sin - half.sin * vv.sin, along = half.sin * v.sin + half.cos * vv.sin,
                 radius = 600 + 250 * across;
    return Int3(glm::round(Vec3(radius * u.cos, radius * u.sin, 250 * along)));
  };
  Body body;
  for (int i = 0; i < kAround; ++i)
    for (int j = 0; j < kAcross; ++j)
      append(body.triangles,
             {{at(i, j), at(i + 1, j), at(i + 1, j + 1)}, {at(i, j), at(i + 1, j + 1), at(i, j + 1)}});
  body.table = false;
  return body;
}

/// The tool: a block of four voxels a side, its origin in the middle of its bottom.
Triangles tool_block() { return box_of(Int3(-128, -128, 0), Int3(128, 128, 256)); }

/// Over the table by a step, on it, sunk into it; else anywhere on the surface, turned by quarters or not at
/// all known.
LatticePose table_pose(const SceneGeometry& geometry, const Body& body, Random& random, Known& known) {
  const std::uint64_t way = random.below(6);
  if (!body.table || way > 2)
    return way % 2 == 0 ? aligned_touching_pose(geometry, random)
                        : random_touching_pose(geometry, 0.5, random);
  LatticePose pose;
  for (int k = 0; k < 3; ++k) pose.rotation_q30[k][k] = 1 << 30;
  pose.translation = {random.between(-120, 120), random.between(-120, 120),
                      512 + (way == 0   ? 1
                             : way == 1 ? 0
                                        : -random.between(1, 60))};
  known.contact = way != 0;
  if (way == 0) {
    known.pairs.emplace();
    known.areas = 0;
  } else if (way == 2) {
    known.areas = body.areas;
  }
  return pose;
}

Case topology(const char* name, const char* about, std::function<Body()> body) {
  Case c;
  c.name = name;
  c.family = "topology";
  c.about = about;
  c.degenerate = true;
  c.share = 0.33;
  c.make = [=](std::uint64_t) -> Result<TestScene> {
    const Body made = body();
    auto geometry = lattice_scene(made.triangles, tool_block(), kVoxel, kVoxel / 2, made.parts);
    if (!geometry) return geometry.error();
    TestScene scene;
    scene.geometry = std::move(*geometry);
    scene.pose = [made](const SceneGeometry& g, Random& r, Known& known) {
      return table_pose(g, made, r, known);
    };
    if (made.classes)
      scene.known_class = [world = *made.classes](const Int3& lower) {
        return world.class_of(lower, kVoxel);
      };
    return scene;
  };
  return c;
}
Case killer(Case c) {
  c.killer = true;
  return c;
}

/// A bead wholly within the tool: no pair, all of it in EST, one area.
Case swallowed_bead() {
  Case c =
      topology("bead_in_tool", "a small box wholly within the tool: no pair, EST is all of it, one area", [] {
        Body body = of_boxes({{Int3(-40, -50, -60), Int3(50, 40, 30), 1}});
        body.table = false;
        return body;
      });
  const auto make = c.make;
  c.make = [make](std::uint64_t seed) {
    auto scene = make(seed);
    if (scene)
      scene->pose = [](const SceneGeometry&, Random& random, Known& known) {
        LatticePose pose;
        for (int k = 0; k < 3; ++k) pose.rotation_q30[k][k] = 1 << 30;
        pose.translation = {random.between(-70, 70), random.between(-70, 70), -128 + random.between(-90, 60)};
        known.pairs.emplace();
        known.contact = known.est = true;
        known.areas = 1;
        return pose;
      };
    return scene;
  };
  return c;
}

}  // namespace

std::vector<Case> topology_cases() {
  return {
      topology("nested_shells", "a closed part within another: winding 2, V_int all the same", nested),
      killer(topology("cavity", "a shell that faces inwards within another: V_ext within V_int", cavity)),
      paper(topology("cavity", "the same to the letter of the chapter", cavity)),
      topology("overlapping_parts", "two closed parts that overlap", overlapping),
      killer(topology("flipped_shell", "an inside-out box is turned round at import", flipped_shell)),
      topology("open_shell", "a box without bottom has no inside", open_box),
      topology("missing_triangle", "nor has one that lacks a single large triangle", missing_triangle),
      killer(topology("t_junction", "closed although a corner lies on an edge; still one area", t_junction)),
      topology("edge_of_four", "two boxes that share one edge", edge_of_four),
      killer(topology("edge_of_three", "a fin on a box's edge: open, and yet with an inside, by vote",
                      edge_of_three)),
      topology("zero_thickness", "front and back in one plane: closed, and without inside", zero_thickness),
      topology("duplicate_parts", "a closed part given twice: winding 2", [] { return duplicates(true); }),
      topology("duplicate_faces", "all faces twice in one part: four triangles on every edge",
               [] { return duplicates(false); }),
      topology("duplicate_triangle", "one triangle twice: open, and yet with an inside, by vote",
               duplicate_triangle),
      topology("gap_of_one_step", "two blocks a step apart: two areas under one tool",
               [] { return two_blocks(1); }),
      topology("no_gap", "two blocks side by side: one area", [] { return two_blocks(0); }),
      killer(topology("overlap_of_one_step", "two blocks that overlap by a step: two areas",
                      [] { return two_blocks(-1); })),
      topology("one_sided", "the tetrahemihexahedron: closed, not orientable", one_sided),
      killer(topology("klein_bottle", "closed, not orientable, through itself", klein_bottle)),
      swallowed_bead(),
  };
}

}  // namespace palpate::equivalence

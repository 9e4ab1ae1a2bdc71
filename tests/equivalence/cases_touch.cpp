// One tool triangle brought to static triangles so that it is known beforehand which of them it meets, a
// lattice step before, at and after the touch (touch_stations.h).
#include "tests/equivalence/case.h"
#include "tests/equivalence/lattice_shapes.h"
#include "tests/equivalence/touch_stations.h"

#include "cpu_ref/exact.h"

namespace palpate::equivalence {
namespace {

using Shape = std::function<TouchShape(Random&)>;

/// One number after the other: in which order a call's arguments are drawn is the compiler's choice.
Int3 any(Random& r, std::int32_t eighths) {
  Int3 out;
  for (int k = 3; k-- > 0;) out[k] = 8 * r.between(-eighths, eighths);
  return out;
}

bool spans_space(const TouchShape& s) {
  return cpu_ref::dot(cpu_ref::cross(Long3(s.p), Long3(s.q)), Long3(s.w)) != 0;
}

/// Corners within 8 · `eighths` steps of each other.
Shape within(std::int32_t eighths) {
  return [=](Random& r) {
    TouchShape s;
    do s = {any(r, eighths), any(r, eighths), any(r, eighths)};
    while (!spans_space(s));
    return s;
  };
}

/// 2^23 steps long or more and some 8 steps wide: aspect above 5·10^5, mostly above 10^6. `middle`: where
/// along the long edge the third corner lies; 0: a needle, else a cap.
Shape slender(int middle) {
  return [=](Random& r) {
    TouchShape s;
    do s = {any(r, 1), any(r, 1), any(r, 1)};
    while (!spans_space({s.p + Int3(1 << 23, 0, 0), s.q, s.w}) ||
           cpu_ref::cross(Long3(1, 0, 0), Long3(s.q)) == Long3(0));
    s.p.x += 8 * r.between(1 << 20, (1 << 20) + (1 << 18));
    s.q.x += s.p.x / 64 * 8 * middle;
    return s;
  };
}

Case touch(const char* name, const char* about, Shape shape, TouchLayout layout) {
  Case c;
  c.name = name;
  c.family = "touch";
  c.about = about;
  c.degenerate = true;
  c.scene_poses = 40;
  c.make = [=](std::uint64_t seed) -> Result<TestScene> {
    Random random(seed, 1'000'000);
    TouchShape s = shape(random);
    const TouchScene made = make_touch_scene(s, layout, random);
    auto geometry = lattice_scene(made.mockup, made.tool, made.voxel, made.voxel / 4);
    if (!geometry) return geometry.error();
    TestScene scene;
    scene.geometry = std::move(*geometry);
    scene.pose = [stations = made.stations](const SceneGeometry&, Random& r, Known& known) {
      return station_pose(stations, r, known);
    };
    return scene;
  };
  return c;
}
Case killer(Case c) {
  c.killer = true;
  c.poses = 40;
  return c;
}

}  // namespace

std::vector<Case> touch_cases() {
  const char* kinds =
      "corner, edge or face against corner, edge or face, coplanar and identical, and a step before and "
      "after";
  const Case small = touch("touch_small", kinds, within(2), {.count = 16});
  return {
      killer(small),
      paper(small),
      killer(touch("touch_large", "the same, 100,000 steps across", within(12500), {.count = 16})),
      touch("touch_on_voxels", "the same with corners on voxels' faces, edges and corners",
            [](Random& r) {
              TouchShape s = within(1)(r);
              return TouchShape{s.p * 16, s.q * 16, s.w * 16};
            },
            {.count = 8, .voxel = 32}),
      killer(touch("touch_needles", "the same with needles of aspect 10^6", slender(0),
                   {.count = 16, .slender = true, .voxel = 1 << 23})),
      touch("touch_caps", "the same with caps of aspect 10^6", slender(3),
            {.count = 16, .slender = true, .voxel = 1 << 23}),
      killer(touch("touch_high_corner", "the same within a few voxels of (2^28, 2^28, 2^28)", within(6),
                   {.count = 8, .corner = 1})),
      touch("touch_low_corner", "the same within a few voxels of (-2^28, -2^28, -2^28)", within(6),
            {.count = 8, .corner = -1}),
      touch("touch_whole_lattice",
            "one touch of triangles that span the lattice: the largest numbers there are", within(1 << 21),
            {.count = 1, .voxel = 1 << 22}),
  };
}

}  // namespace palpate::equivalence

#pragma once
#include <functional>
#include <initializer_list>
#include <optional>
#include <utility>

#include "model/generate/turn.h"
#include "tests/equivalence/case.h"
#include "tests/equivalence/lattice_shapes.h"
#include "tests/equivalence/rectangles.h"

namespace palpate::equivalence {

// What the cases of family `rules` are made of: bodies in lattice steps, voxels of kVoxel, and poses by hand.

inline constexpr std::int32_t kVoxel = 64;

using PoseOf = std::function<LatticePose(const SceneGeometry&, Random&, Known&)>;

inline LatticePose unturned(const Int3& translation) {
  LatticePose pose;
  for (int k = 0; k < 3; ++k) pose.rotation_q30[k][k] = 1 << 30;
  pose.translation = translation;
  return pose;
}

inline Int3 any(Random& random, std::int32_t reach) {
  return {random.between(-reach, reach), random.between(-reach, reach), random.between(-reach, reach)};
}

/// One side (2·axis + upper) of a box.
inline Triangles side_of(const Int3& min, const Int3& max, std::size_t side) {
  const Triangles box = box_of(min, max);
  return {box[2 * side], box[2 * side + 1]};
}

inline Triangles together(std::initializer_list<Triangles> parts) {
  Triangles all;
  for (const Triangles& part : parts) append(all, part);
  return all;
}

inline Case rule(const char* name, const char* about, Triangles mockup, Triangles tool, PoseOf pose,
                 std::optional<RectangleWorld> classes = {}, std::int32_t spacing = kVoxel / 2) {
  Case c;
  c.name = name;
  c.family = "rules";
  c.about = about;
  c.degenerate = true;
  c.killer = true;
  c.poses = 12;
  c.share = 0.1;
  c.make = [=](std::uint64_t) -> Result<TestScene> {
    auto geometry = lattice_scene(mockup, tool, kVoxel, spacing);
    if (!geometry) return geometry.error();
    TestScene scene;
    scene.geometry = std::move(*geometry);
    scene.pose = pose;
    if (classes)
      scene.known_class = [world = *classes](const Int3& lower) { return world.class_of(lower, kVoxel); };
    return scene;
  };
  return c;
}
inline Case ignoring(Case c) {
  c.name += "_ignoring";
  c.ignoring = true;
  return c;
}

inline Triangles small_box() { return box_of(Int3(-40), Int3(40)); }
inline Triangles block() { return box_of(Int3(-512), Int3(512)); }

/// Turned about x by up to an eighth.
inline LatticePose leaning(Random& random, const Int3& translation) {
  const Turn turn = turn_by((random.unit() - 0.5) / 4);
  LatticePose pose = unturned(translation);
  pose.rotation_q30[1][1] = pose.rotation_q30[2][2] = static_cast<std::int32_t>(turn.cos * 0x1p30);
  pose.rotation_q30[2][1] = static_cast<std::int32_t>(turn.sin * 0x1p30);
  pose.rotation_q30[1][2] = -pose.rotation_q30[2][1];
  return pose;
}

}  // namespace palpate::equivalence

#pragma once
#include <vector>

#include "model/lattice/pose.h"
#include "model/mesh/mesh.h"

namespace palpate {

/// Two bodies at a pose whose force is known in closed form, whatever the tessellation, and how they are
/// sampled. The force is the field's alone, without the spring.
struct NumericsScene {
  Mesh mockup, tool;
  Pose pose;
  double stiffness = 2000, voxel = 2e-3, spacing = 0.25e-3;  ///< N/m, m
  double reference_area = 0;                                 ///< m²: (the tool's longest side / 8)²
  bool contact = true;
  Vec3 force{0};      ///< N, the truth
  double length = 0;  ///< m: what decides, where that is short: a depth, a gap, an overlap; 0: nothing is
};

/// A cube of 20 mm on its corner in a plane: what is turned to extremes.
struct CornerExtreme {
  double scale = 1;          ///< of the whole scene
  double offset = 0;         ///< m along x and, half of it, along y
  double depth = 3e-3;       ///< m before scaling
  double spacing = 0.25e-3;  ///< m before scaling
  double stiffness = 2000;   ///< N/m
  int strips = 1;            ///< the plane's face is cut into so many along y: ever narrower triangles
  double voxel = 2e-3;       ///< m before scaling
};
NumericsScene corner_scene(const CornerExtreme& extreme);

/// A bar `aspect` times as long as it is wide (4 mm), pressed flat 0.2 mm into a plane, turned to the grid.
NumericsScene long_patch(double aspect);

/// A plate pressed 0.2 mm into count × count pads of 2 mm, 4 mm apart.
NumericsScene many_patches(int count);

/// A square peg of 20 mm in a square hole with `play` times 20 mm on each side: in the middle, where nothing
/// touches, or twice the play to one side, where the overlap is the play.
NumericsScene peg_with_play(double play, bool aside);

/// A tongue of 20 mm between two walls that it overlaps by `overlap` times 20 mm on each side, half of that
/// to one side.
NumericsScene tongue_pressed(double overlap);

/// A bar of side `slimness` times its length (50 mm) that stands on a plane, pressed in by a twentieth of its
/// side: hung on the spring K, and how stiff its contact is beside that spring.
struct HungBar {
  NumericsScene scene;  ///< force: with the spring; the pose is the device's
  double ratio = 0;     ///< of the contact's stiffness over K
};
HungBar hung_bar(double slimness);

}  // namespace palpate

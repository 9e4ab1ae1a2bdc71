#pragma once
#include "bench/haptic/case.h"

namespace yardstick {

/// A block of 120 × 120 × 20 mm whose top is the plane z = 0.
TriMesh ground();

/// Beside the ground's edge x = 60 mm, with the tool's height and turn as in `deep`: along x until all of the
/// tool that is in the ground at `deep` has left it, up by `lift`, back and down: a loop that leaves a
/// contact sideways.
std::vector<Pose> over_the_edge(const TriMesh& tool, const Pose& deep, double lift, std::size_t count);

/// `tool`, symmetric about a vertical axis through its centre, is pressed straight into the ground, from
/// just above it to `depth`.
Case on_plane(const std::string& name, const std::string& group, TriMesh tool, double depth,
              const Amount& amount);

}  // namespace yardstick

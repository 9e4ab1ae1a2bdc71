#pragma once
#include <array>
#include <cstdint>
#include <vector>

#include "model/lattice/lattice.h"
#include "model/lattice/lattice_mesh.h"
#include "model/lattice/vector.h"

namespace palpate::peers {

/// Triangles that take part in anything. A collapsed one meets nothing, but peers would report it: they are
/// given the others alone, and `ids` leads back.
struct Body {
  std::vector<std::uint32_t> ids;
  std::vector<std::array<std::uint32_t, 3>> triangles;  ///< vertex numbers, one a number in `ids`
};

inline Body body_of(const LatticeMesh& mesh) {
  Body out;
  for (std::uint32_t t = 0; t < mesh.triangles.size(); ++t) {
    if (mesh.collapsed(t)) continue;
    out.ids.push_back(t);
    out.triangles.push_back(mesh.triangles[t]);
  }
  return out;
}

/// The pose as a rigid motion in metres from the lattice's origin; turned vertices differ from the lattice's
/// by up to a step.
struct RigidMotion {
  double rotation[3][3];
  Vec3 translation_m;
};

inline RigidMotion rigid_motion(const LatticePose& pose, double step_m) {
  RigidMotion out{};
  for (std::size_t i = 0; i < 3; ++i)
    for (std::size_t j = 0; j < 3; ++j)
      out.rotation[i][j] = static_cast<double>(pose.rotation_q30[i][j]) * 0x1p-30;
  out.translation_m = step_m * Vec3(pose.translation);
  return out;
}

}  // namespace palpate::peers

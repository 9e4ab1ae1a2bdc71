#pragma once
#include <cstdint>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "model/lattice/pose.h"
#include "model/mesh/mesh.h"

namespace palpate {

/// Two parts, a smooth path of the tool, and what is true of the force along it, from symmetry or closed
/// form.
struct ForceCase {
  /// What holds at the pose `at` of the path.
  struct Truth {
    std::size_t at = 0;
    std::optional<Vec3> direction{};  ///< of the force, with `direction_deg`
    double direction_deg = 3;
    std::optional<double> most_force{};  ///< N: no more than this
    std::optional<Vec3>
        couple_against{};  ///< the torque about the tool's centre has a negative component along this axis
  };
  std::string name{};
  Mesh mockup{}, tool{};
  double voxel_m = 0;  ///< 0: the program's choice
  std::vector<Pose> path;
  bool loop = false;  ///< the last pose is the first: the work along it is 0
  bool slips =
      false;  ///< the tool is pushed until it lets go: there the force drops in a step, and work is lost
  std::optional<Vec3> approach{};  ///< the way the tool goes all along: no force along it at first touch, and
                                   ///< no loss while it goes deeper
  std::vector<Truth> truths{};
  double most_antisymmetry = 0.02;  ///< of ∂F; more where the case says why
};

/// The tool hangs by K in all of them, N/m.
inline constexpr double kForceStiffness = 2000;

/// A case and how to make it: meshes take memory.
struct ForceCaseMaker {
  std::string name;
  std::function<ForceCase()> make;
};
std::vector<ForceCaseMaker> force_cases();

}  // namespace palpate

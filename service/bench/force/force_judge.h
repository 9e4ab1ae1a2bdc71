#pragma once
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "model/collision_backend.h"
#include "model/contact/response.h"
#include "model/scene/scene.h"
#include "service/bench/force/force_cases.h"

namespace palpate {

/// What a path of forces is like. K is the stiffness of the tool's spring, ρ the tool's radius of gyration.
struct ForceFigures {
  std::size_t poses = 0, touching = 0;
  std::vector<double> force_n;  ///< |F| by pose
  double largest_n = 0;
  double largest_step = 0;          ///< |ΔF| / (K (|Δp| + ρ |Δθ|)) between neighbours
  std::size_t largest_step_at = 0;  ///< the later of the two
  std::size_t reversals =
      0;  ///< neighbours whose forces, both above a hundredth of the largest, are more than 90° apart
  std::size_t made_up = 0, unsettled = 0;  ///< poses in contact where no direction is known; where spring and
                                           ///< field were not brought to balance
  /// Largest step and reversals of a hand that goes along the path, each pose's balance looked for from the
  /// one before; of poses before real parts. Where a wall is thin or a shell open there may be two balances,
  /// and lone poses step from one to the other where a hand stays in its own.
  std::optional<double> hand_step;
  std::size_t hand_reversals = 0;
  double loop_share = 0;  ///< |∮ dW| / ∮ |dW|, where the case is a loop
  /// |A − Aᵀ| / |A + Aᵀ| of A = ∂(F, T/ρ)/∂(x, ρθ) at the pose of the largest force; where the tool slips, of
  /// the largest up to half of it
  double antisymmetry = 0;
  double first_along = 0;  ///< F · approach of the first pose with a force, over |F|; above 0: pulled in
  double largest_loss =
      0;  ///< while going deeper: how far below the largest so far |F| falls, of the largest
  std::vector<std::string> broken;  ///< sentences: what is not as the case or the limits say
};

/// Limits that hold for every case (docs/ACCURACY.md).
inline constexpr double kMostStep = 3, kMostLoop = 0.03, kMostLoss = 0.05;

/// Scales a case's voxel, its own or the program's: 1, or 0.5 and 2 to see whether it matters. Errors: as
/// build_geometry, and the back end's.
Result<ForceFigures> judge_force(const ForceCase& subject, CollisionBackend& backend, Profile profile,
                                 double voxel_scale = 1);

/// Told how much of a path is done; false: the user wants no more of it.
using PathProgress = std::function<bool(double done)>;

/// The same for geometry that is prepared already. Error (kInternal): ended by `go_on`.
Result<ForceFigures> judge_path(const ForceCase& subject, const SceneGeometry& geometry,
                                CollisionBackend& backend, Profile profile, double stiffness,
                                const PathProgress& go_on = {});

/// Adds `hand_step` and `hand_reversals` to the figures of a path in `refined`. `start`: as for a run, what
/// touches at the path's first pose is left out until it has opened, or not.
Result<void> judge_hand(const ForceCase& subject, const SceneGeometry& geometry, CollisionBackend& backend,
                        double stiffness, StartContacts start, ForceFigures& out,
                        const PathProgress& go_on = {});

/// `count` poses along a path, evenly by its numbers, straight between two and turned evenly.
std::vector<Pose> finer_path(const std::vector<Pose>& path, std::size_t count);

}  // namespace palpate

#pragma once
#include <array>

#include "service/loop/force_law.h"

namespace palpate {

/// The spring between tool and device.
struct CouplingSettings {
  double stiffness_n_per_m = 0;     ///< 0: tool and device are in one place
  double stiffness_nm_per_rad = 0;  ///< 0: they are turned alike

  /// Whether there is one.
  bool on() const { return stiffness_n_per_m > 0 || stiffness_nm_per_rad > 0; }
};

/// A small motion: of gc, and a turn, world axes.
using Vec6 = std::array<double, 6>;

/// Where the tool is, `apart` from the device.
LawPose apart_from(const LawPose& device, const Vec6& apart, const CouplingSettings& spring);

/// What pushes the tool at a pose and how that gives way there, as ForceLawState::feel: the gradient of a
/// convex energy.
class Feel {
 public:
  virtual ~Feel() = default;
  /// `push`: the wrench on a tool at `tool`; `slope`: how it changes with the place.
  virtual void operator()(const LawPose& tool, Wrench& push, StiffnessMatrix& slope) const = 0;
};

/// Where spring and push balance: the one minimum of push's energy plus ½ spring (tool − device)², by
/// Newton's method from `apart` on, with steps that don't pass the minimum by much. Plain arithmetic on fixed
/// memory: no clock, no allocation.
Vec6 spring_balance(const CouplingSettings& spring, const LawPose& device, Vec6 apart, const Feel& feel);

inline constexpr int kMostBalanceEvaluations =
    80;  ///< of what pushes; from the tick before two or three are enough, among walls of 10^6 N/m behind 1
         ///< kN/m up to 60 (measured)
inline constexpr double kEnoughBalanceJ = 1e-16;  ///< 0.3 µN against 1 kN/m (chosen)

}  // namespace palpate

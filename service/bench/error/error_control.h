#pragma once
#include <vector>

#include "service/loop/force_law.h"

namespace palpate {

/// Force felt against the force at zero delay, for a hand that presses into a contact and draws back.
struct ControlError {
  LawKind law = LawKind::kCorrected;
  int age = 1;          ///< ticks: a result is so old when it comes, and the next comes as much later
  int transitions = 0;  ///< n; 0: auto
  std::vector<double> errors_n;  ///< one a tick, N
  double step_us = 0;            ///< mean time of a tick of the law
};

/// One run in virtual time over a sphere of 20 mm in a plane (K d with the closed form of d, a curved
/// contact: κ changes with depth), two presses of 3 mm.
ControlError control_error(LawKind law, int age, int transitions);

}  // namespace palpate

#pragma once
#include <functional>
#include <string>
#include <vector>

#include "service/bench/stability/stability_contacts.h"
#include "service/loop/body_loop.h"

namespace palpate {

/// A tool in six degrees of freedom against walls, in somebody's device and hand.
struct BodyCase {
  std::string name;
  DeviceSettings device;
  std::vector<Pad> pads;
};

/// A plate on four pads, on a corner, in a hole, at the end of a lever; a light and a heavy device, one held
/// by a hand, one with forces alone, one with torques alone, and the chapter's rig of one force and three
/// torques.
std::vector<BodyCase> body_cases();

/// The case with a law, results `delay` ticks old and apart: pressed deep (linear), or, `bounces`, dropped on
/// the pads from 1 mm, tilted by 20 mrad, by 1 N.
BodyLoop body_loop(const SimulatedMaker& make, const BodyCase& what, LawKind law, int delay, double stiffness,
                   bool bounces = false, const CouplingSettings& coupling = {});

/// Highest stable K of it, N/m, by bisection between 10 and 100,000 N/m of runs of 20 s.
double highest_stable_body(const SimulatedMaker& make, const BodyCase& what, LawKind law, int delay,
                           bool bounces = false, const CouplingSettings& coupling = {});

/// The same over the real query, the tool in a contact of stability_contacts.h and free in all six axes;
/// results `delay` ticks old, 0: none. Law `corrected` with the spring that goes with profile `refined`; the
/// others hold or carry on what a lone query would feel. Runs of 2 s. Errors: the engine's own; `stopped`
/// says so (may be empty).
Result<double> highest_stable_body_query(const SimulatedMaker& make, const ContactCase& what,
                                         PreparedCase& prepared, const DeviceSettings& device, LawKind law,
                                         int delay, const std::function<bool()>& stopped = {});

/// Whether it is stable at a K.
Result<bool> stable_body_query(const SimulatedMaker& make, const ContactCase& what, PreparedCase& prepared,
                               const DeviceSettings& device, LawKind law, int delay, double stiffness,
                               const std::function<bool()>& stopped = {});

/// 0.5 kg and 2 g·m², 1 N·s/m and 5 mN·m·s, held by next to nothing, but against toppling.
DeviceSettings bare_device();

}  // namespace palpate

#pragma once
#include <map>
#include <string>
#include <vector>

#include "model/collision_backend.h"
#include "model/contact/response.h"
#include "model/lattice/pose.h"

namespace palpate {

/// A scene under one plan at a row of poses, each frame holding on to the one before.
struct PlanTrial {
  struct Frame {
    Contacts contacts;
    ContactResponse response;
  };
  std::vector<Frame> frames;     ///< one a pose
  std::vector<double> frame_us;  ///< the least of the rounds, one a pose
  std::map<std::string, double>
      stage_us;                     ///< median over the poses in contact, over all poses if there is none
  std::vector<StageMemory> memory;  ///< by stage of the plan
  std::uint64_t memory_bytes = 0;
};

/// What is asked of a plan.
struct PlanQuestion {
  const SceneGeometry* geometry = nullptr;
  std::vector<Pose> poses;
  double stiffness_n_per_m = 2000;
  bool cpu_clock = false;  ///< by the time that this process itself ran
};

/// Goes through the poses once more under `plan`, and adds what it sees to `trial`. The back end has been
/// prepared for the geometry in the plan's profile; its first round warms up and is the only one whose
/// answers are kept. Errors: the back end's; a pose; a truncated frame.
Result<void> try_plan(CollisionBackend& backend, const PlanQuestion& question, const Plan& plan,
                      std::uint64_t rounds, PlanTrial& trial);

/// The first thing that both plans work out and that differs, in words; empty: all the same bits. What one of
/// the two leaves out isn't compared.
std::string difference(const PlanTrial& whole, const PlanTrial& lean);

/// The lean plan's time over the whole's, pose by pose: the median, and an interval that holds it in 95 of
/// 100 cases whatever the times' distribution (order statistics). Over the poses in contact, over all if
/// there is none.
struct PlanRatio {
  double median = 1, low = 1, high = 1;
};
PlanRatio time_ratio(const PlanTrial& whole, const PlanTrial& lean);

/// Median over the frames in contact, over all if there is none, µs.
double median_frame_us(const PlanTrial& trial);

}  // namespace palpate

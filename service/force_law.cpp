#include "service/force_law.h"

#include <algorithm>
#include <cmath>

#include "model/rotation.h"

namespace palpate {
namespace {

/// What a result's planes say at another pose. No plane pulls.
Wrench pushed(const LawResult& result, const LawPose& pose) {
  Wrench sum;
  if (result.plane_count == 0) return sum;
  const Vec3 moved = pose.gc - result.gc;
  const Vec3 turned = rotation_vector(pose.rotation * glm::conjugate(result.rotation));   // the short way
  for (std::uint32_t i = 0; i < result.plane_count; ++i) {
    const ContactPlane& plane = result.planes[i];
    const double out = glm::dot(plane.normal, moved) + glm::dot(plane.lever, turned);   // n_cᵀ J ΔX
    const double force = std::max(0.0, plane.force - plane.stiffness * out);
    sum.force += force * plane.normal;
    sum.torque += force * plane.lever;
  }
  return sum;
}

}  // namespace

ForceLawState::ForceLawState(const ForceLawSettings& settings) : settings_(settings) {
  settings_.transitions = std::clamp(settings_.transitions, 0, kMaxTransitions);
  if (settings_.transitions > 0) transitions_ = settings_.transitions;
}

Wrench ForceLawState::step(const LawPose& pose, const LawResult* fresh) {
  took_fresh_ = fresh && fresh->tick > newest_tick_;
  if (took_fresh_) {
    newest_tick_ = fresh->tick;
    measure_age(pose.tick - fresh->tick);
  } else {
    fresh = nullptr;
  }
  switch (settings_.kind) {
    case LawKind::kHold:
      if (fresh) force_ = fresh->wrench;
      return force_;
    case LawKind::kPrinted:
      return printed(pose, fresh);
    case LawKind::kCorrected:
      return corrected(pose, fresh);
  }
  return {};
}

void ForceLawState::measure_age(std::int64_t age) {
  if (settings_.transitions > 0) return;
  // A mean over about the last 8 results: steady enough not to hunt, quick enough to follow a scene.
  const double ticks = static_cast<double>(std::clamp<std::int64_t>(age, 1, kMaxTransitions));
  mean_age_ = mean_age_ == 0 ? ticks : mean_age_ + (ticks - mean_age_) / 8;
  transitions_ = std::clamp(static_cast<int>(std::lround(mean_age_)), 1, kMaxTransitions);
}

/// Equations 4–6 to the letter. They print K(U_h(i) − U_h(i−j)), the displacement alone, so rotation changes nothing
/// and K pulls along every direction, in free space too.
Wrench ForceLawState::printed(const LawPose& pose, const LawResult* fresh) {
  if (newest_tick_ < 0) return {};
  const double k = settings_.stiffness_n_per_m;
  if (fresh) {   // eq. 4 and 5
    step_.force = (fresh->wrench.force - k * (pose.gc - fresh->gc) - force_.force) / static_cast<double>(transitions_);
    step_.torque = (fresh->wrench.torque - force_.torque) / static_cast<double>(transitions_);
    steps_left_ = transitions_;
  } else {       // eq. 6
    force_.force -= k * (pose.gc - last_gc_);
  }
  if (steps_left_ > 0 || !settings_.printed_stops_at_n) {
    force_.force += step_.force;
    force_.torque += step_.torque;
    if (steps_left_ > 0) --steps_left_;
  }
  last_gc_ = pose.gc;
  return force_;
}

Wrench ForceLawState::corrected(const LawPose& pose, const LawResult* fresh) {
  if (fresh) {
    newest_ = static_cast<std::uint32_t>((newest_ + 1) % ring_.size());
    // A full ring gives up its oldest, whose share falls to the next: only after n has shrunk a lot at once.
    live_ = std::min<std::uint32_t>(live_ + 1, static_cast<std::uint32_t>(ring_.size()));
    ring_[newest_] = {*fresh, pose.tick, transitions_};
  }
  // From the newest back: `taken` is the share of all newer ones; each adds what its own ramp is ahead of them.
  Wrench sum;
  double taken = 0;
  for (std::uint32_t back = 0; back < live_; ++back) {
    const Generation& at = generation(back);
    const double ramp = static_cast<double>(pose.tick - at.arrived + 1) / at.transitions;
    const double reached = std::min(ramp, 1.0);
    if (reached > taken) {
      const Wrench push = pushed(at.result, pose);
      sum.force += (reached - taken) * push.force;
      sum.torque += (reached - taken) * push.torque;
      taken = reached;
    }
    if (taken >= 1) live_ = back + 1;   // everything older is gone
  }
  return sum;   // what nobody has taken belongs to the time before the first result: no force
}

}  // namespace palpate

#include "service/loop/force_law.h"

#include <algorithm>
#include <cmath>

#include "driver/haptic_device.h"
#include "driver/limits.h"
#include "model/lattice/rotation.h"

namespace palpate {
namespace {

// In a tick of 1 ms a hand goes no further (chosen: 50 m/s, 500 rad/s); a device that homes or slips does.
constexpr double kJump = 0.05, kJumpTurn = 0.5;  // m, rad
constexpr double kLeastLever =
    0.02;  // m: nearer to gc than that, torques are weighed as if it were so far (chosen)

double size(const Vec3& v) { return std::sqrt(glm::dot(v, v)); }

double longest_lever(const PlaneSet& set) {
  double longest = 0;
  for (std::uint32_t i = 0; i < set.plane_count; ++i)
    longest = std::max(longest, glm::dot(set.planes[i].lever, set.planes[i].lever));
  return std::sqrt(longest);
}

bool usable(const LawResult& result) { return sound(result) && finite(result.wrench); }

}  // namespace

ForceLawState::ForceLawState(const ForceLawSettings& settings) : settings_(settings) {
  settings_.transitions = std::clamp(settings_.transitions, 0, kMaxTransitions);
  if (settings_.transitions > 0) transitions_ = settings_.transitions;
}

Wrench ForceLawState::step(const LawPose& pose, const LawResult* fresh) {
  took_fresh_ = fresh && fresh->tick > newest_tick_ && fresh->tick <= pose.tick && usable(*fresh);
  if (took_fresh_) {
    newest_tick_ = fresh->tick;
    measure_age(pose.tick - fresh->tick);
  } else {
    fresh = nullptr;
  }
  const Wrench force = by_law(pose, fresh);
  last_ = pose;
  stepped_ = true;
  return force;
}

Wrench ForceLawState::by_law(const LawPose& pose, const LawResult* fresh) {
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

/// Equations 4–6 to the letter. They print K(U_h(i) − U_h(i−j)), the displacement alone, so rotation changes
/// nothing and K pulls along every direction, in free space too.
Wrench ForceLawState::printed(const LawPose& pose, const LawResult* fresh) {
  if (newest_tick_ < 0) return {};
  const double k = settings_.stiffness_n_per_m;
  if (fresh) {  // eq. 4 and 5
    step_.force =
        (fresh->wrench.force - k * (pose.gc - fresh->gc) - force_.force) / static_cast<double>(transitions_);
    step_.torque = (fresh->wrench.torque - force_.torque) / static_cast<double>(transitions_);
    steps_left_ = transitions_;
  } else {  // eq. 6
    force_.force -= k * (pose.gc - last_.gc);
  }
  if (steps_left_ > 0 || !settings_.printed_stops_at_n) {
    force_.force += step_.force;
    force_.torque += step_.torque;
    if (steps_left_ > 0) --steps_left_;
  }
  return force_;
}

Wrench ForceLawState::corrected(const LawPose& pose, const LawResult* fresh) {
  const double ticks = stepped_ ? static_cast<double>(std::max<std::int64_t>(pose.tick - last_.tick, 1)) : 1;
  const double went = stepped_ ? size(pose.gc - last_.gc) : 0;
  const double turned = stepped_ ? size(rotation_vector(pose.rotation * glm::conjugate(last_.rotation))) : 0;
  jumped_ = went > kJump * ticks || turned > kJumpTurn * ticks;
  if (jumped_) {
    forget(pose);
    if (fresh && fresh->tick < pose.tick) fresh = nullptr, took_fresh_ = false;
  }
  if (fresh) take(pose, *fresh);

  const Wrench before = pushed(from_, pose.gc, pose.rotation, from_grows_),
               after = pushed(to_, pose.gc, pose.rotation);
  if (share_ >= 1) return after;
  const double lever = std::max({longest_lever(from_), longest_lever(to_), kLeastLever});
  const double gap = std::max(size(after.force - before.force), size(after.torque - before.torque) / lever);
  double step = ticks / transitions_;
  if (settings_.change_n_per_s > 0) {
    const double may = settings_.change_n_per_s * kTickSeconds * ticks +
                       2 * settings_.stiffness_n_per_m * (went + lever * turned);
    // What a ramp of n ticks can't bridge is a change of areas.
    if (fresh) from_grows_ = gap <= may * transitions_;
    step = std::min(step, may / std::max(gap, 1e-12));
  }
  share_ = std::min(share_ + step, 1.0);
  return {before.force + share_ * (after.force - before.force),
          before.torque + share_ * (after.torque - before.torque)};
}

void ForceLawState::feel(const Vec3& gc, const Quat& rotation, Wrench& force,
                         StiffnessMatrix& stiffness) const {
  force = {};
  stiffness = {};
  add_pushed(force, stiffness, from_, 1 - share_, gc, rotation, from_grows_);
  add_pushed(force, stiffness, to_, share_, gc, rotation);
  for (std::size_t row = 0; row < 6; ++row)
    for (std::size_t column = 0; column < row; ++column) stiffness[column][row] = stiffness[row][column];
}

/// From here on: from what is felt now to the new result.
void ForceLawState::take(const LawPose& pose, const LawResult& result) {
  PlaneSet felt;
  felt.gc = pose.gc;
  felt.rotation = pose.rotation;
  add_pushes(felt, to_, share_);
  add_pushes(felt, from_, 1 - share_, from_grows_);
  PlaneSet next = static_cast<const PlaneSet&>(result);
  std::array<LawPose, kMaxLawPlanes> seen;
  for (std::uint32_t i = 0; i < next.plane_count; ++i) seen[i] = {result.tick, result.gc, result.rotation};
  remember(result, next, seen);
  from_ = felt;
  to_ = next;
  std::copy_n(seen.begin(), next.plane_count, seen_.begin());
  share_ = 0;
  from_grows_ = true;
}

/// Adds to `next`, the planes of a new result, those of to_ that the result doesn't speak about.
void ForceLawState::remember(const LawResult& result, PlaneSet& next,
                             std::array<LawPose, kMaxLawPlanes>& seen) const {
  const Vec3 moved = result.gc - to_.gc;
  const Vec3 turned = rotation_vector(result.rotation * glm::conjugate(to_.rotation));
  for (std::uint32_t i = 0; i < to_.plane_count && next.plane_count < kMaxLawPlanes; ++i) {
    ContactPlane plane = to_.planes[i];
    plane.force -= plane.stiffness * (glm::dot(plane.normal, moved) + glm::dot(plane.lever, turned));
    if (plane.force > 0 || !(plane.stiffness > 0) || -plane.force > kKeepAway * plane.stiffness) continue;
    const LawPose& last = seen_[i];
    const Vec3 went = result.gc - last.gc;
    const double along =
        size(went - glm::dot(went, plane.normal) * plane.normal) +
        size(plane.lever) * size(rotation_vector(result.rotation * glm::conjugate(last.rotation)));
    if (along > kKeepAlong || result.tick - last.tick > kKeepTicks) continue;
    bool known = false;  // the result has an area of the same wall
    for (std::uint32_t p = 0; p < result.plane_count; ++p)
      known = known || (glm::dot(result.planes[p].normal, plane.normal) > 0.9 &&
                        size(result.planes[p].lever - plane.lever) < kLeastLever);
    if (known) continue;
    seen[next.plane_count] = last;
    next.planes[next.plane_count++] = plane;
  }
}

void ForceLawState::forget(const LawPose& pose) {
  from_.plane_count = to_.plane_count = 0;
  share_ = 1;
  newest_tick_ = std::max(newest_tick_, pose.tick - 1);  // results for poses before are worth nothing
}

}  // namespace palpate

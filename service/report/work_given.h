#pragma once
#include <cmath>

#include "service/loop/run_record.h"

namespace palpate {

/// The work that the device does on the hand: each tick's force and torque, held for the tick, over the way
/// that the tool's centre of mass goes and the turn that it makes. A passive contact never does more than the
/// hand put in before: the sum is then at most 0, but for what a tick's hold makes.
class WorkGiven {
 public:
  explicit WorkGiven(const Vec3& tool_gc_m) : tool_gc_m_(tool_gc_m) {}

  /// The sum up to this tick's pose, J.
  double push(const TickRecord& tick) {
    const Vec3 gc = tick.pose.position + tick.pose.rotation * tool_gc_m_;
    if (begun_) {
      Quat turn = tick.pose.rotation * glm::conjugate(rotation_);
      if (turn.w < 0) turn = -turn;
      const Vec3 axis(turn.x, turn.y, turn.z);
      const double sine = glm::length(axis);
      const Vec3 angle = sine > 0 ? axis * (2 * std::atan2(sine, turn.w) / sine) : Vec3(0);
      const double work = glm::dot(sent_.force, gc - gc_) + glm::dot(sent_.torque, angle);
      if (std::isfinite(work)) sum_j_ += work;
    }
    begun_ = true;
    gc_ = gc, rotation_ = tick.pose.rotation, sent_ = tick.sent;
    return sum_j_;
  }

 private:
  Vec3 tool_gc_m_, gc_{0};
  Quat rotation_{1, 0, 0, 0};
  Wrench sent_;
  bool begun_ = false;
  double sum_j_ = 0;
};

}  // namespace palpate

#include "service/loop/realtime_estimate.h"

#include <cmath>

namespace palpate {

void RealtimeEstimate::frame(std::int64_t tick, double us) noexcept {
  before_ = last_;
  last_ = {tick, us};
}

void RealtimeEstimate::ask(std::int64_t pose, double at_ms) noexcept {
  asked_ = true;
  asked_pose_ = pose;
  answered_ms_ = at_ms + (last_.tick <= pose ? last_ : before_).us / 1000;
}

void RealtimeEstimate::tick(std::int64_t tick) noexcept {
  const auto now_ms = static_cast<double>(tick);
  bool fresh = false;
  // Between two ticks the worker ends at most the query that was under way and one for a pose that had come
  // meanwhile.
  while (asked_ && answered_ms_ <= now_ms) {
    asked_ = false;
    fresh = true;
    newest_pose_ = asked_pose_;
    const auto pose = static_cast<std::int64_t>(std::floor(answered_ms_));
    if (pose > asked_pose_) ask(pose, answered_ms_);
  }
  if (!asked_ && tick > asked_pose_) ask(tick, now_ms);

  if (newest_pose_ >= 0) result_age_.add(tick - newest_pose_);
  if (fresh) ticks_since_fresh_ = 0;
  if (watchdog_ticks_ > 0 && ticks_since_fresh_ >= watchdog_ticks_) ++faded_ticks_;
  ++ticks_since_fresh_;
}

}  // namespace palpate

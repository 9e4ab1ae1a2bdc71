#pragma once
#include <cstdint>

#include "service/loop/histogram.h"

namespace palpate {

/// What real time would have made of a run in virtual time: the loop's ticks a millisecond apart, and beside
/// it a collision worker that is always at the newest pose (CollisionWorker), each of its queries as long as
/// the measured one at the last pose before. It decides nothing. Wake-ups and a late loop are not in it: with
/// both, results are older.
class RealtimeEstimate {
 public:
  explicit RealtimeEstimate(int watchdog_ticks) : watchdog_ticks_(watchdog_ticks) {}

  /// A query for the pose of `tick` took `us` microseconds. Ascending; before tick() of the same one.
  void frame(std::int64_t tick, double us) noexcept;
  /// The loop's tick number `tick`, from 0, every one.
  void tick(std::int64_t tick) noexcept;

  /// Ticks, over ticks that would have had a result.
  const Histogram& result_age() const { return result_age_; }
  /// Ticks without a fresh result for longer than the watchdog, as SafeDevice counts them.
  std::uint64_t watchdog_ticks() const { return faded_ticks_; }

 private:
  struct Measured {
    std::int64_t tick = 0;
    double us = 0;
  };
  void ask(std::int64_t pose, double at_ms) noexcept;

  int watchdog_ticks_;
  Measured last_, before_;
  bool asked_ = false;             ///< a query is under way,
  std::int64_t asked_pose_ = -1;   ///< for the pose of this tick,
  double answered_ms_ = 0;         ///< until then
  std::int64_t newest_pose_ = -1;  ///< of the newest result; −1: none yet
  int ticks_since_fresh_ = 0;
  Histogram result_age_;
  std::uint64_t faded_ticks_ = 0;
};

}  // namespace palpate

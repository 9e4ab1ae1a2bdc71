#pragma once
#include <algorithm>
#include <chrono>
#include <cstddef>

namespace palpate {

/// Goes through many poses a portion at a time, so that whoever wants to stop is heard after about a second,
/// or after 16 poses where an engine is slow: 16 to begin with, 16 times as many after a portion that took
/// less than a sixteenth of a second, a sixteenth after one that took more than one (chosen).
class Portions {
 public:
  using Clock = std::chrono::steady_clock;
  static constexpr std::size_t kLeast = 16;

  /// `count` poses, no more than `most` at a time.
  Portions(std::size_t count, std::size_t most) : all_(count), most_(most) {}

  /// Goes on to the next portion; false: all have been. The one before has taken from the last call on.
  bool next(Clock::time_point now = Clock::now()) {
    first_ += count_;
    if (count_ == size_) {
      const std::chrono::duration<double> took = now - begun_;
      if (took.count() < 1.0 / 16) size_ *= 16;
      if (took.count() > 1) size_ = std::max(size_ / 16, kLeast);
    }
    size_ = std::min(size_, most_);
    begun_ = now;
    count_ = std::min(size_, all_ - first_);
    return count_ != 0;
  }
  std::size_t first() const { return first_; }
  std::size_t count() const { return count_; }

 private:
  std::size_t all_, most_;
  std::size_t size_ = kLeast, first_ = 0, count_ = 0;
  Clock::time_point begun_{};
};

}  // namespace palpate

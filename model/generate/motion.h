#pragma once
#include <cmath>
#include <cstdint>
#include <vector>

#include "model/generate/turn.h"
#include "model/scene/scene.h"

namespace palpate {

/// Writes a hand's intended motion down: from one pose to the next, starting and ending at rest.
class Motion {
 public:
  /// `place`: position in m (guided: its x is the travel); `turn`: rotation vector, rad.
  Motion(const Vec3& place, const Vec3& turn, int stage) : place_(place), turn_(turn) {
    add(place, turn, stage);
  }

  /// Moves within `seconds` (a multiple of 20 ms) with the least jerk: 10 f³ − 15 f⁴ + 6 f⁵.
  void go(const Vec3& place, const Vec3& turn, double seconds, int stage) {
    const int steps = static_cast<int>(std::lround(seconds * kRate));
    for (int i = 1; i <= steps; ++i) {
      const double f = static_cast<double>(i) / steps;
      const double g = f * f * f * (10 + f * (-15 + 6 * f));
      ++tick_;
      add(place_ + (place - place_) * g, turn_ + (turn - turn_) * g, stage);
    }
    place_ = place;
    turn_ = turn;
  }

  void turn_to(const Vec3& turn, double seconds, int stage) { go(place_, turn, seconds, stage); }
  void rest(double seconds, int stage) { go(place_, turn_, seconds, stage); }

  std::vector<PathPoint> take() { return std::move(path_); }

 private:
  static constexpr int kRate = 50;  ///< points a second (chosen: the device interpolates)

  void add(const Vec3& place, const Vec3& turn, int stage) {
    path_.push_back({static_cast<double>(tick_) / kRate, {place, rotation_about(turn)}, place.x, stage});
  }

  std::vector<PathPoint> path_;
  Vec3 place_, turn_;
  std::int64_t tick_ = 0;
};

}  // namespace palpate

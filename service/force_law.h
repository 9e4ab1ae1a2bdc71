#pragma once
#include <array>
#include <cstdint>

#include "model/pose.h"
#include "service/law_result.h"

namespace palpate {

/// Most ticks over which a result is blended in.
inline constexpr int kMaxTransitions = 64;

enum class LawKind : std::uint8_t {
  kHold,        ///< the last result, unchanged: the yardstick
  kPrinted,     ///< equations 4–6 of the chapter as printed
  kCorrected,   ///< per area, never pulling (below)
};

struct ForceLawSettings {
  LawKind kind = LawKind::kCorrected;
  double stiffness_n_per_m = 2000;   ///< K of equations 4–6; `corrected` takes κ from each plane instead
  int transitions = 0;               ///< n, 1 … kMaxTransitions; 0: auto, the mean age at which results arrive
  bool printed_stops_at_n = false;   ///< true: ΔM is added n times at most, not until the next result (for comparison)
};

/// Where the tool is at a tick.
struct LawPose {
  std::int64_t tick = 0;
  Vec3 gc{0};                  ///< centre of mass, world, m
  Quat rotation{1, 0, 0, 0};   ///< world from tool
};

/// From results that come late and seldom to a force at every tick (chapter 3.3). Plain data and arithmetic: no clock, no
/// thread, no allocation; the same inputs give the same bits. 150 kB: keep it off small stacks.
///
/// `corrected`. A result is a set of planes, each pushing along its own n_c with max(0, K d − κ n_cᵀ J ΔX), so no area ever
/// pulls, whatever its age. A new result comes in over n ticks as a cross-fade between what the old and the new planes say at
/// the present pose: shares 1/n, 2/n, … 1, then the old one is gone. On one linear contact that is equation 5 with the hand's
/// motion put back (P = M_h(i−1) − K(U_h(i) − U_h(i−1)); ΔM = (target − P)/n), since both follow the motion; being
/// a mean of pushes, it can't pull, and a late result can't be overshot, as the ramp ends. With n above the time between
/// results several fade at once, each over its own n ticks (a moving mean), where the equation would start a new ramp.
class ForceLawState {
 public:
  explicit ForceLawState(const ForceLawSettings& settings);

  /// Force on the tool at this tick, torque about pose.gc. `fresh` is the newest result or null; one that has been
  /// seen (the same tick) or is older than the newest seen is ignored. Call it every tick.
  Wrench step(const LawPose& pose, const LawResult* fresh);

  int transitions() const { return transitions_; }   ///< n in use
  bool took_fresh() const { return took_fresh_; }     ///< the last step used a new result

 private:
  struct Generation {
    LawResult result;
    std::int64_t arrived = 0;   ///< tick of the first share
    int transitions = 1;        ///< n when it arrived
  };
  void measure_age(std::int64_t age);
  Wrench printed(const LawPose& pose, const LawResult* fresh);
  Wrench corrected(const LawPose& pose, const LawResult* fresh);
  Generation& generation(std::uint32_t back) { return ring_[(newest_ + ring_.size() - back) % ring_.size()]; }

  ForceLawSettings settings_;
  int transitions_ = 1;
  double mean_age_ = 0;          ///< ticks; 0: nothing measured
  std::int64_t newest_tick_ = -1;
  bool took_fresh_ = false;

  Wrench force_;                 ///< hold, printed: M_h
  Wrench step_;                  ///< printed: ΔM_h
  int steps_left_ = 0;           ///< printed
  Vec3 last_gc_{0};              ///< printed: U_h(i − 1)

  std::array<Generation, kMaxTransitions + 1> ring_{};   ///< corrected: results that still have a share
  std::uint32_t newest_ = 0, live_ = 0;
};

}  // namespace palpate

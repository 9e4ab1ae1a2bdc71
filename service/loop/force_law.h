#pragma once
#include <array>
#include <cstdint>

#include "model/lattice/pose.h"
#include "service/loop/law_result.h"

namespace palpate {

/// Most ticks over which a result is blended in.
inline constexpr int kMaxTransitions = 1000;

/// The law that runs.
enum class LawKind : std::uint8_t {
  kHold,       ///< the last result, unchanged: the yardstick
  kPrinted,    ///< equations 4–6 of the chapter as printed
  kCorrected,  ///< per area, never pulling (below)
};

/// Which law, and its constants.
struct ForceLawSettings {
  LawKind kind = LawKind::kCorrected;
  double stiffness_n_per_m = 2000;  ///< K of equations 4–6; `corrected` takes κ from each plane instead
  int transitions = 0;  ///< n, 1 … kMaxTransitions; 0: auto, the mean age at which results arrive
  bool printed_stops_at_n =
      false;  ///< true: ΔM is added n times at most, not until the next result (for comparison)
  double change_n_per_s =
      0;  ///< `corrected`: how fast force may change while the hand rests (below); 0: no limit
};

/// Where the tool is at a tick.
struct LawPose {
  std::int64_t tick = 0;
  Vec3 gc{0};                 ///< centre of mass, world, m
  Quat rotation{1, 0, 0, 0};  ///< world from tool
};

/// From results that come late and seldom to a force at every tick (chapter 3.3). Plain data and arithmetic:
/// no clock, no thread, no allocation; the same inputs give the same bits.
///
/// `corrected`. A result is a set of planes, each pushing along its own n_c with max(0, K d − κ n_cᵀ J ΔX),
/// so no area ever pulls, whatever its age. When a new result comes, what is felt at that moment is put down
/// as a set of planes, too, and the law goes over from that set to the new one by shares 1/n, 2/n, … 1 of
/// what both say at the present pose. On one linear contact that is equation 5 with the hand's motion put
/// back (P = M_h(i−1) − K(U_h(i) − U_h(i−1)); ΔM = (target − P)/n); being a mean of pushes, it can't pull,
/// and a late result can't be overshot, as the ramp ends.
///
/// Areas merge, split, begin and end, and the chapter's response jumps with them (a force an area: one pad of
/// two gives half the force of two). The present pose is the same before and after, so the jump is in no way
/// the hand's doing, and the law spreads it out: in a tick the share grows by no more than brings
///     change_n_per_s · 1 ms + 2 K · (the way the tool's contact points went in this tick)
/// of force, or as much torque at the longest lever. So the force never jumps: in one tick it changes by at
/// most (κ + 2K) times that way plus the rest's rate. The second term lets the wall that a fast hand runs
/// into build up as fast as a wall does. What is left behind by such a change may only give way, not grow: it
/// may not be there any more.
///
/// A plane outlives its contact. A result without contact says nothing about a wall that the tool has just
/// left: its plane, which gives no force there either, agrees with it. So it is kept, for a hand that comes
/// back must not fall in until the next result: with results 10 ticks old that alone makes a bounce that
/// never ends at a fifth of the stable K. A plane is given up when a result finds the tool behind it, with an
/// area like it or without, when the contact point has gone `kKeepAlong` along it or `kKeepAway` from it, and
/// after `kKeepTicks`.
class ForceLawState {
 public:
  static constexpr double kKeepAlong = 5e-3,
                          kKeepAway = 20e-3;  ///< m (chosen: a wall seldom ends within millimetres)
  static constexpr int kKeepTicks = 250;      ///< (chosen: a bounce that a hand can feel is shorter)

  /// No contact so far.
  explicit ForceLawState(const ForceLawSettings& settings);

  /// Force on the tool at this tick, torque about pose.gc. `fresh` is the newest result or null; one that has
  /// been seen (the same tick), is older than the newest seen, from the future, or not finite is ignored.
  /// Call it every tick.
  Wrench step(const LawPose& pose, const LawResult* fresh);

  /// `corrected`: what step() would say at another pose now if no result came and its share stood still, and
  /// how that gives way there. The force never grows as the tool gives way to it.
  void feel(const Vec3& gc, const Quat& rotation, Wrench& force, StiffnessMatrix& stiffness) const;

  /// Another change_n_per_s from here on.
  void limit_change(double n_per_s) { settings_.change_n_per_s = n_per_s; }

  int transitions() const { return transitions_; }  ///< n in use
  bool took_fresh() const { return took_fresh_; }   ///< the last step used a new result
  /// `corrected`: the pose went further in a tick than a hand can; all was forgotten.
  bool jumped() const { return jumped_; }

 private:
  void measure_age(std::int64_t age);
  Wrench by_law(const LawPose& pose, const LawResult* fresh);
  Wrench printed(const LawPose& pose, const LawResult* fresh);
  Wrench corrected(const LawPose& pose, const LawResult* fresh);
  void take(const LawPose& pose, const LawResult& result);
  void remember(const LawResult& result, PlaneSet& next, std::array<LawPose, kMaxLawPlanes>& seen) const;
  void forget(const LawPose& pose);

  ForceLawSettings settings_;
  int transitions_ = 1;
  double mean_age_ = 0;  ///< ticks; 0: nothing measured
  std::int64_t newest_tick_ = -1;
  bool took_fresh_ = false;

  Wrench force_;        ///< hold, printed: M_h
  Wrench step_;         ///< printed: ΔM_h
  int steps_left_ = 0;  ///< printed

  LawPose last_;          ///< of the tick before
  bool stepped_ = false;  ///< there was one
  bool jumped_ = false;

  PlaneSet from_, to_;  ///< corrected: what was felt when the newest result came; that result and what is
                        ///< kept of older ones
  std::array<LawPose, kMaxLawPlanes> seen_{};  ///< by plane of to_: of the result that had it
  double share_ = 1;                           ///< of to_, the rest is from_'s
  bool from_grows_ = true;
};

}  // namespace palpate

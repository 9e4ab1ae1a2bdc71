#pragma once
#include <array>
#include <cstdint>
#include <limits>
#include <span>

#include "model/collision_backend.h"
#include "model/contact/response.h"
#include "model/scene/plan.h"
#include "model/scene/scene.h"
#include "model/scene/scene_geometry.h"
#include "service/loop/frame_budget.h"
#include "service/loop/histogram.h"
#include "service/loop/law_result.h"
#include "service/loop/plan_switch.h"
#include "service/loop/run_record.h"

namespace palpate {

/// A pose on its way from the control loop to the collision worker.
struct PoseSample {
  std::int64_t tick = -1;
  Pose pose;
};

/// A query's pose and outcome; reused from frame to frame so that its lists keep their memory.
struct FrameSlot {
  PoseSample sample;
  LatticePose lattice_pose;
  Contacts contacts;
  ContactResponse response;
  double total_us = 0;
  bool after_gap = false;  ///< as FrameRecord's

  FrameRecord record() const {
    return {sample.tick, sample.pose, lattice_pose, contacts, response, total_us, after_gap};
  }
};

/// From this tick's pose on a session answered in another profile.
struct ProfileChange {
  std::int64_t tick = 0;
  Profile profile = Profile::kRefined;
};

/// A frame that took long, and where most of its time went.
struct SlowFrame {
  PoseSample sample;
  double us = 0;
  const char* stage = "";  ///< empty: the back end told none
  double stage_us = 0;
};

/// Answers one pose after the other: query, respond, and what the force law needs of it.
/// Used by one thread at a time. Allocates only as the back end and growing lists do.
class CollisionFrame {
 public:
  /// All outlive this. `plans`: where other plans come from in mid-run, with back ends of their own; may be
  /// null. `torques`: the device has torque axes; without them the plan may have left out contact points, so
  /// torques and levers are not used. `start`: what becomes of contacts that the first frame has. `slow_us`:
  /// frames that take longer are counted. `budget_us`: frames that take longer are sampled coarser
  /// (`refined`); 0: none is.
  CollisionFrame(const SceneGeometry& geometry, CollisionBackend& backend, Profile profile, double stiffness,
                 bool torques, PlanSwitch* plans = nullptr, StartContacts start = StartContacts::kAsIs,
                 double slow_us = std::numeric_limits<double>::infinity(), double budget_us = 0);

  /// Fills `slot` (its sample is set by the caller) and `result`. An error means that the back end failed, by
  /// status or by exception, or that the pose isn't one: the caller sends zero force.
  Result<void> solve(FrameSlot& slot, LawResult& result) noexcept;

  const Histogram& frame_ns() const { return frame_ns_; }
  std::uint64_t frames() const { return frame_ns_.total(); }
  std::uint64_t slow_frames() const { return slow_frames_; }
  const SlowFrame& slowest() const { return slowest_; }  ///< of slow_frames(); tick −1: there is none
  std::uint64_t truncated_frames() const { return truncated_frames_; }
  const char* truncated_capacity() const { return truncated_capacity_; }  ///< of the last truncated frame
  /// With contact and nothing that pushes (kFlagNoDirection).
  std::uint64_t no_direction_frames() const { return no_direction_frames_; }
  const PoseSample& no_direction_first() const { return no_direction_first_; }  ///< of the first of them
  /// The contacts that are left out, as they are there from the start and have not opened yet; null: none.
  const Ignored* ignored() const { return ignored_.patches.empty() ? nullptr : &ignored_; }
  const FrameBudget& budget() const { return budget_; }
  std::size_t ignored_at_first() const { return ignored_at_first_; }  ///< patches
  std::uint64_t plan_changes() const { return plan_changes_; }
  /// The first kToldChanges of them that changed the profile.
  std::span<const ProfileChange> profile_changes() const {
    return {profile_changes_.data(), profile_change_count_};
  }
  static constexpr std::size_t kToldChanges = 16;  ///< chosen: nobody reads more
  std::uint32_t areas_max() const { return areas_max_; }
  /// More areas than the force law keeps apart.
  std::uint64_t merged_frames() const { return merged_frames_; }

 private:
  void take_plan(std::int64_t tick) noexcept;
  void note_slow(const FrameSlot& slot) noexcept;
  void ignore_what_has_not_opened(const Contacts& contacts);
  Result<void> answer(FrameSlot& slot, LawResult& result);

  const SceneGeometry& geometry_;
  CollisionBackend* backend_;
  PlanSwitch* plans_;
  Profile profile_;
  double stiffness_;
  bool torques_;
  Ignored ignored_;            ///< to begin with, of start contacts that are to be ignored, every patch
  bool ignored_known_ = true;  ///< false: it is still every patch
  std::size_t ignored_at_first_ = 0;
  Histogram frame_ns_;
  FrameBudget budget_;
  double slow_us_;
  std::uint64_t slow_frames_ = 0;
  SlowFrame slowest_;
  std::uint64_t plan_changes_ = 0;
  std::array<ProfileChange, kToldChanges> profile_changes_{};
  std::size_t profile_change_count_ = 0;
  std::uint32_t felt_changes_ = 0;
  std::uint64_t truncated_frames_ = 0, merged_frames_ = 0;
  const char* truncated_capacity_ = "";
  std::uint64_t no_direction_frames_ = 0;
  PoseSample no_direction_first_;
  std::uint32_t areas_max_ = 0;
};

}  // namespace palpate

#pragma once
#include <array>
#include <atomic>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "driver/haptic_device.h"
#include "model/collision_backend.h"
#include "model/result.h"
#include "model/scene/scene.h"
#include "service/loop/plan_switch.h"
#include "service/loop/run_record.h"

namespace palpate {

/// By the clock, or in virtual time.
enum class Pace : std::uint8_t {
  kRealtime,  ///< 1 kHz by the clock, collision worker on a thread of its own
  kAsap,      ///< virtual time: one thread, no clock in anything that decides, the same bytes every time
};

/// Another plan at a tick of a run.
struct PlanChange {
  std::int64_t tick = 0;
  PlanTarget target;
};

/// How run_session() runs.
struct SessionOptions {
  Pace pace = Pace::kRealtime;
  std::optional<double> duration_s{};  ///< empty: to the end of the device's path; without a path: until stop
                                       ///< in real time, one second in virtual time
  PlanSwitch* plans =
      nullptr;  ///< where other plans come from in mid-run, asked through it or by `changes`; may be null
  std::vector<PlanChange> changes{};  ///< ascending; needs `plans`. In virtual time the new plan answers from
                                      ///< its tick on, in real time once it has been prepared
  bool room = false;  ///< in real time: the process's other threads stay off the loop's processor meanwhile
                      ///< (LoopRoom, service/loop/thread_share.h)
  bool give_way = false;  ///< in real time: the calling thread, which records, runs at lower priority from
                          ///< then on, for good
  const std::atomic<bool>* stop =
      nullptr;  ///< set it (also from a signal handler) to end the run with zero force
};

/// Percentiles of a fixed-memory histogram, exact to 2 % (max is exact).
struct Percentiles {
  double p50 = 0, p99 = 0, p999 = 0, max = 0;
};

/// `count` values in [low, high).
struct HistogramBin {
  double low = 0, high = 0;
  std::uint64_t count = 0;
};

/// How the run stood in real time; of one in virtual time, how it would have stood
/// (service/loop/realtime_estimate.h).
struct RealtimeOutlook {
  bool kept_up = false;  ///< results came, and the watchdog never faded the force; the sentence also says
                         ///< whether they were older than in virtual time
  Percentiles result_age_ticks;
  std::uint64_t watchdog_ticks = 0;  ///< ticks without a fresh result for longer than the watchdog
  std::string sentence;
};

/// What summary.json tells, with the names it has there, and a few more.
struct SessionSummary {
  std::uint64_t static_triangles = 0, tool_triangles = 0;  ///< of the scene's meshes
  std::string backend, device;  ///< the engine that answered last, "gpu", "cpu" or "ref", and what it runs on
  std::string haptic_device;
  std::string profile;  ///< "paper" or "refined"
  std::string law;      ///< "printed" or "corrected"
  std::uint64_t ticks = 0, missed_ticks = 0;
  Percentiles lateness_us;                     ///< real time only: wake-up after the scheduled time
  std::vector<HistogramBin> lateness_bins_us;  ///< ascending, a quarter of an octave each, without empty ones
  Percentiles result_age_ticks;                ///< over ticks that had a result
  std::vector<HistogramBin> result_age_bins_ticks;  ///< likewise, an age each
  Percentiles frame_us;                             ///< wall time a query, pose in to wrench out
  std::vector<int> stages_reached;                  ///< ascending
  std::uint32_t areas_max = 0;                      ///< most areas with a force in one frame
  double force_max_N = 0, torque_max_Nm = 0;        ///< sent to the device
  std::uint64_t frames = 0;
  std::uint64_t no_direction_frames = 0;  ///< in contact, and nothing said which way: no force was made up
  std::int64_t no_direction_tick = 0;     ///< of the first of them
  Pose no_direction_pose;                 ///< and its tool pose
  std::uint64_t coarse_frames = 0;  ///< sampled coarser than their contact asks for (response.budget_us)
  double coarsest_share = 1;        ///< of the samples that it asks for, in the coarsest of them
  std::uint64_t ignored_patches_first =
      0;  ///< patches of the mock-up whose contacts at the start were left out
  std::uint64_t ignored_patches_end = 0;    ///< of them, those that had not opened by the end
  std::optional<RealtimeOutlook> realtime;  ///< empty: the run ended before a result was due
  std::uint64_t watchdog_ticks = 0;         ///< ticks without a fresh result for longer than the watchdog
  std::uint64_t saturated_ticks = 0;        ///< ticks where a device limit shortened force or torque
  std::uint64_t plan_changes = 0;           ///< in mid-run
  /// Profiles that the run went over to: the first CollisionFrame::kToldChanges.
  struct Changed {
    std::int64_t tick;         ///< of the first pose answered in it
    std::string profile, law;  ///< as SessionSummary's
  };
  std::vector<Changed> profile_changes;
  std::uint64_t dropped_ticks = 0,
                dropped_frames = 0;  ///< not recorded because the recording thread fell behind
  std::vector<std::string> static_parts,
      tool_parts;        ///< paths of the parts that touched, ascending; filled in by who watches the frames
  bool stopped = false;  ///< ended by `stop`, before its duration
  std::optional<Error> failure;  ///< why the run ended before its time: back end, device fault, exception,
                                 ///< recording; with zero force
  std::vector<std::string>
      notes;  ///< one sentence each: no real-time priority, watchdog, truncation, the back end's, …
};

/// Runs the 1 kHz loop on `device` and `backend` (which has been prepared for scene.geometry) and returns
/// when the run is over. Profile, K, law, n, delays and fades come from scene.scene. Opens the device, wraps
/// it in SafeDevice, and on every way out sends zero force and closes it. `observer` may be null. Errors,
/// each one sentence: kNoDevice (open failed), kBadValue (a setting), kInternal (no memory, no thread). A run
/// that began and failed later has a summary, too: with `failure`.
Result<SessionSummary> run_session(const LoadedScene& scene, CollisionBackend& backend, HapticDevice& device,
                                   const SessionOptions& options, RunObserver* observer);

}  // namespace palpate

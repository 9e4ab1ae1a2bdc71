#include "service/loop/session.h"

#include <sys/mman.h>

#include <algorithm>
#include <boost/lockfree/spsc_queue.hpp>
#include <chrono>
#include <cmath>
#include <exception>
#include <limits>
#include <memory>
#include <string>
#include <thread>
#include <utility>

#include "driver/device_notes.h"
#include "driver/safe_device.h"
#include "service/loop/collision_frame.h"
#include "service/loop/collision_worker.h"
#include "service/loop/control_loop.h"
#include "service/loop/realtime_estimate.h"
#include "service/loop/thread_share.h"

namespace palpate {
namespace {

constexpr int kMaxVirtualDelay = 1000;     ///< ticks; a result a second old is no use to anybody (chosen)
constexpr double kMaxFadeMs = 60'000;      ///< chosen
constexpr std::size_t kTickQueue = 16384;  ///< 16 s of ticks until a stalled disk costs a row (chosen)
constexpr std::uint64_t kForever = std::numeric_limits<std::uint64_t>::max();

std::string number(double value) {
  std::string text = std::to_string(value);
  text.erase(text.find_last_not_of('0') + 1);
  if (text.back() == '.') text.pop_back();
  return text;
}

Result<void> check(const Scene& scene, const SessionOptions& options) {
  const auto wrong = [&](const std::string& name, double value, const std::string& allowed) {
    return bad_value(scene.file + ": " + name + " is " + number(value) + ", allowed is " + allowed);
  };
  const ControlSettings& control = scene.control;
  const double stiffness = scene.response.stiffness_n_per_m;
  if (!std::isfinite(stiffness) || stiffness < 0)
    return wrong("response.stiffness", stiffness, "a finite number of N/m from 0");
  if (control.transitions && (*control.transitions < 1 || *control.transitions > kMaxTransitions))
    return wrong("control.transitions", *control.transitions,
                 "1 to " + std::to_string(kMaxTransitions) + " ticks, or auto");
  if (control.virtual_delay_ticks < 1 || control.virtual_delay_ticks > kMaxVirtualDelay)
    return wrong("control.virtual_delay_ticks", control.virtual_delay_ticks,
                 "1 to " + std::to_string(kMaxVirtualDelay));
  if (!(control.watchdog_ms >= 0 && control.watchdog_ms <= kMaxFadeMs))
    return wrong("control.watchdog_ms", control.watchdog_ms, "0 to 60000");
  if (!(control.fade_in_ms >= 0 && control.fade_in_ms <= kMaxFadeMs))
    return wrong("control.fade_in_ms", control.fade_in_ms, "0 to 60000");
  if (!(control.change_n_per_s >= 0 && std::isfinite(control.change_n_per_s)))
    return wrong("control.change_n_per_s", control.change_n_per_s, "a finite number of N/s from 0");
  if (!(control.slew_ms >= 0 && control.slew_ms <= kMaxFadeMs))
    return wrong("control.slew_ms", control.slew_ms, "0 to 60000");
  for (const auto& [name, spring] : {std::pair{"control.coupling_n_per_m", control.coupling_n_per_m},
                                     {"control.coupling_nm_per_rad", control.coupling_nm_per_rad}}) {
    const double value = spring.value_or(0);
    if (!(value >= 0 && std::isfinite(value))) return wrong(name, value, "a finite number from 0");
    if (value > 0 && control.law == ForceLaw::kPrinted)
      return wrong(name, value, "0 with law printed: the coupling needs the planes of law corrected");
  }
  if (options.duration_s && !(*options.duration_s > 0 && *options.duration_s <= 1e9))
    return bad_value("the duration is " + number(*options.duration_s) + " s, allowed is more than 0 to 1e9");
  return {};
}

/// How many ticks a run takes. The last point of the device's own motion, and its stage, are part of it.
std::uint64_t tick_count(const HapticDevice& device, const SessionOptions& options) {
  const auto ticks = [](double seconds) {
    return static_cast<std::uint64_t>(std::max(std::llround(seconds / kTickSeconds), 1LL));
  };
  if (options.duration_s) return ticks(*options.duration_s);
  if (device.motion_s() > 0) return ticks(device.motion_s()) + 1;
  return options.pace == Pace::kAsap ? ticks(1) : kForever;
}

/// An observer behind a guard: null is fine, what it throws becomes an error, and after an error it is left
/// alone.
class GuardedObserver {
 public:
  explicit GuardedObserver(RunObserver* observer) : observer_(observer) {}

  bool tick(const TickRecord& record) {
    return call([&] { return observer_->on_tick(record); });
  }
  bool frame(const FrameRecord& record) {
    return call([&] { return observer_->on_frame(record); });
  }
  const std::optional<Error>& error() const { return error_; }

 private:
  template <class Call>
  bool call(Call call_observer) {
    if (!observer_) return true;
    if (error_) return false;
    try {
      if (auto done = call_observer(); !done) error_ = done.error();
    } catch (const std::exception& thrown) {
      error_ = Error{ErrorCode::kInternal, std::string("recording the run failed: ") + thrown.what()};
    } catch (...) {
      error_ = Error{ErrorCode::kInternal, "recording the run failed for an unknown reason"};
    }
    return !error_;
  }

  RunObserver* observer_;
  std::optional<Error> error_;
};

int in_ticks(double ms) { return static_cast<int>(std::lround(ms / 1000 / kTickSeconds)); }
int watchdog_ticks(const Scene& scene) { return in_ticks(scene.control.watchdog_ms); }

/// From where on a frame is slow: while one of that length is under way, the watchdog runs out.
double slow_us(const Scene& scene) {
  return watchdog_ticks(scene) > 0 ? 1e6 * kTickSeconds * watchdog_ticks(scene)
                                   : std::numeric_limits<double>::infinity();
}

/// Everything that both paces use.
struct Run {
  Run(const LoadedScene& loaded, CollisionBackend& backend, SafeDevice& safe,
      const SessionOptions& session_options, RunObserver* run_observer)
      : scene(loaded.scene),
        options(session_options),
        device(safe),
        frame(loaded.geometry, backend, loaded.scene.response.profile,
              loaded.scene.response.stiffness_n_per_m, has_torques(safe), session_options.plans,
              loaded.scene.start_contacts, slow_us(loaded.scene),
              session_options.pace == Pace::kRealtime ? loaded.scene.response.budget_us : 0),
        tick(safe, law_settings(loaded.scene), loaded.geometry.tool_gc_m,
             couplings_of(loaded.scene, loaded.geometry.tool_gyration_m),
             loaded.scene.response.profile == Profile::kRefined, other_law(loaded.scene)),
        observer(run_observer),
        estimate(watchdog_ticks(loaded.scene)),
        ticks(tick_count(safe, session_options)) {}

  static bool has_torques(const SafeDevice& safe) {
    const auto can = safe.capabilities().actuated;
    return can[3] || can[4] || can[5];
  }
  static ForceLawSettings law_settings(const Scene& scene) {
    return {.kind = scene.control.law == ForceLaw::kPrinted ? LawKind::kPrinted : LawKind::kCorrected,
            .stiffness_n_per_m = scene.response.stiffness_n_per_m,
            .transitions = scene.control.transitions.value_or(0),
            .change_n_per_s = scene.control.change_n_per_s};
  }

  /// Of the profile that the scene doesn't begin with.
  static LawKind other_law(const Scene& scene) {
    if (scene.control.law_stated) return law_settings(scene).kind;
    return scene.response.profile == Profile::kPaper ? LawKind::kCorrected : LawKind::kPrinted;
  }

  const Scene& scene;
  const SessionOptions& options;
  SafeDevice& device;
  CollisionFrame frame;
  ControlTick tick;
  GuardedObserver observer;
  RealtimeEstimate estimate;  ///< of virtual time
  std::uint64_t ticks;
  LoopTiming timing;
  std::uint64_t dropped_ticks = 0, dropped_frames = 0;
  std::string realtime_note;
  std::optional<Error> error;
};

/// Hands out the changes whose tick has come.
class Changes {
 public:
  explicit Changes(const SessionOptions& options) : options_(options) {}
  template <class Take>
  void up_to(std::int64_t tick, Take&& take) {
    for (; options_.plans && next_ < options_.changes.size() && options_.changes[next_].tick <= tick; ++next_)
      take(*options_.plans, options_.changes[next_].target);
  }

 private:
  const SessionOptions& options_;
  std::size_t next_ = 0;
};

/// Virtual time: the answer to the pose of tick i arrives at tick i + delay, and then the next query starts.
/// Nothing here asks a clock but to tell how real time would have been, so equal scenes give equal bytes.
void run_asap(Run& run) {
  const std::int64_t delay = run.scene.control.virtual_delay_ticks;
  FrameSlot slot;
  Changes changes(run.options);
  LawResult arrived, pending;
  for (std::int64_t i = 0; static_cast<std::uint64_t>(i) < run.ticks; ++i) {
    if (run.options.stop && run.options.stop->load(std::memory_order_relaxed)) {
      run.timing.stopped = true;
      return;
    }
    const PoseSample sample = run.tick.sense(i);
    const LawResult* fresh = nullptr;
    if (run.tick.device_failed()) return;
    if (i % delay == 0) {
      arrived = pending;
      if (arrived.tick >= 0) fresh = &arrived;
      changes.up_to(i, [](PlanSwitch& plans, const PlanTarget& target) { plans.prepare_now(target); });
      slot.sample = sample;
      if (auto solved = run.frame.solve(slot, pending); !solved) {
        run.error = solved.error();
        return;
      }
      run.estimate.frame(i, slot.total_us);
      if (!run.observer.frame(slot.record())) return;
    }
    run.estimate.tick(i);
    if (!run.observer.tick(run.tick.act(fresh))) return;
  }
}

/// Real time: the control loop and the collision worker on their own threads; this thread records.
void run_realtime(Run& run) {
  using TickQueue = boost::lockfree::spsc_queue<TickRecord, boost::lockfree::capacity<kTickQueue>>;
  const auto records = std::make_unique<TickQueue>();
  CollisionWorker worker(run.frame);
  Changes changes(run.options);
  LoopSignals signals;
  signals.stop = run.options.stop;
  RealtimeGrant granted;
  std::optional<LoopRoom> room;
  if (run.options.room) room.emplace();
  worker.start();
  std::thread loop([&] {
    const ForHand for_hand;
    granted = make_realtime();
    const TickSink sink = [](void* queue, const TickRecord& record) noexcept {
      return static_cast<TickQueue*>(queue)->push(record);
    };
    run.dropped_ticks =
        run_realtime_loop(run.tick, run.device, worker, run.ticks, signals, run.timing, sink, records.get());
  });
  if (run.options.give_way)
    set_nice(kNiceConnections);  // the other two have been made: a thread begins at its maker's level

  const auto drain = [&] {
    records->consume_all([&](const TickRecord& record) {
      changes.up_to(record.tick, [](PlanSwitch& plans, const PlanTarget& target) { plans.request(target); });
      run.observer.tick(record);
    });
    while (FrameSlot* slot = worker.next_frame()) {
      run.observer.frame(slot->record());
      worker.release(slot);
    }
    if (run.observer.error()) signals.abort.store(true, std::memory_order_relaxed);
  };
  while (!signals.done.load(std::memory_order_acquire)) {
    drain();
    std::this_thread::sleep_for(std::chrono::milliseconds(3));
  }
  loop.join();    // the device is at zero force and closed
  worker.stop();  // may take as long as a query
  drain();
  if (granted.locked) munlockall();
  run.realtime_note = granted.refused;
  run.dropped_frames = worker.dropped_frames();
  if (worker.error()) run.error = worker.error();
}

Percentiles percentiles(const Histogram& histogram, double unit) {
  return {histogram.percentile(0.5) / unit, histogram.percentile(0.99) / unit,
          histogram.percentile(0.999) / unit, histogram.max() / unit};
}

std::vector<HistogramBin> bins(const Histogram& histogram, bool coarse, double unit) {
  std::vector<HistogramBin> out;
  histogram.each(coarse, [&](double low, double high, std::uint64_t count) {
    out.push_back({low / unit, high / unit, count});
  });
  return out;
}

/// Why the run ended before its time, if it did.
std::optional<Error> failure_of(const Run& run) {
  if (run.error) return Error{run.error->code, run.error->sentence + "; the run has ended with zero force"};
  if (run.device.faulted())
    return Error{ErrorCode::kInternal, "haptic device '" + run.device.name() + "': " + run.device.fault() +
                                           "; the run has ended with zero force"};
  return run.observer.error();
}

/// The simulated hand is a mass before a spring: held against a contact as stiff as K it swings, which is no
/// fault of the response. Empty: another device, no force, or well damped.
std::string swing_of_the_hand(const Scene& scene, double force_max_N) {
  const DeviceSettings& device = scene.device;
  if (device.driver != "simulated" || device.path.empty() || force_max_N <= 0) return {};
  const double mass = device.mass_kg + device.hand_mass_kg,
               damping = device.damping_n_s_per_m + device.hand_damping_n_s_per_m;
  const double stiffness = scene.response.stiffness_n_per_m + device.hand_stiffness_n_per_m;
  constexpr double kDamped = 0.4;  // of critical damping: a step overshoots by a quarter (chosen)
  if (damping > kDamped * 2 * std::sqrt(mass * stiffness)) return {};
  const double hertz = std::sqrt(stiffness / mass) / (2 * 3.14159265358979323846);
  return "the simulated hand, " + number(std::round(100 * mass) / 100) +
         " kg with its device, swings when it meets a contact, at up to " +
         number(std::round(10 * hertz) / 10) +
         " Hz: such swings of the force after a first touch are the hand's";
}

std::string ticks_text(double ticks) {
  return number(std::round(ticks)) + (std::round(ticks) == 1 ? " tick" : " ticks");
}
std::string position_text(const Pose& pose) {
  const auto micrometres = [](double m) { return number(std::round(m * 1e6) / 1e6 + 0.0); };  // no "-0"
  return micrometres(pose.position.x) + " " + micrometres(pose.position.y) + " " +
         micrometres(pose.position.z) + " m";
}

/// What a run in virtual time shows is what a hand would have felt only where the machine would have brought
/// results as early.
std::optional<RealtimeOutlook> outlook(const Run& run, const SessionSummary& summary) {
  const bool virtual_time = run.options.pace == Pace::kAsap;
  // A run that ended before a result was due says nothing of the machine.
  if (run.tick.result_age().total() == 0 && (virtual_time || summary.watchdog_ticks == 0)) return {};
  const bool any = (virtual_time ? run.estimate.result_age() : run.tick.result_age()).total() > 0;
  RealtimeOutlook out;
  out.result_age_ticks = virtual_time ? percentiles(run.estimate.result_age(), 1) : summary.result_age_ticks;
  out.watchdog_ticks = virtual_time ? run.estimate.watchdog_ticks() : summary.watchdog_ticks;
  out.kept_up = any && out.watchdog_ticks == 0;
  const std::string could =
      virtual_time ? (out.kept_up ? "this machine would have kept up" : "this machine could not have kept up")
                   : (out.kept_up ? "this machine kept up" : "this machine did not keep up");
  const bool older = out.result_age_ticks.p99 > summary.result_age_ticks.p99;
  out.sentence = could + (out.kept_up && older ? ", with older results than this run's: " : ": ");
  if (!any) {
    out.sentence += std::string("no result ") + (virtual_time ? "would have come in " : "came in ") +
                    ticks_text(static_cast<double>(run.tick.ticks()));
    return out;
  }
  if (out.watchdog_ticks > 0)
    out.sentence += std::string("the watchdog ") + (virtual_time ? "would have faded" : "faded") +
                    " the force out in " + std::to_string(out.watchdog_ticks) + " of " +
                    std::to_string(run.tick.ticks()) + " ticks, ";
  out.sentence += std::string("results ") + (virtual_time ? "would have been " : "were ") +
                  ticks_text(out.result_age_ticks.p50) + " old, " +
                  number(std::round(out.result_age_ticks.p99)) + " at p99, " +
                  number(std::round(out.result_age_ticks.max)) + " at most";
  if (virtual_time)
    out.sentence += " (in this run " + number(std::round(summary.result_age_ticks.p50)) + ", " +
                    number(std::round(summary.result_age_ticks.p99)) + ", " +
                    number(std::round(summary.result_age_ticks.max)) + ")";
  if (virtual_time && !out.kept_up && run.scene.response.budget_us > 0)
    out.sentence +=
        "; real time samples coarser where that keeps frames to response.budget_us, virtual time "
        "never does";
  if (!virtual_time && summary.coarse_frames > 0)
    out.sentence += "; " + std::to_string(summary.coarse_frames) + " of " + std::to_string(summary.frames) +
                    " frames were sampled coarser";
  return out;
}

SessionSummary summarise(const Run& run, const LoadedScene& scene, CollisionBackend& backend,
                         const HapticDevice& device) {
  SessionSummary out;
  out.static_triangles = scene.geometry.mockup.triangles.size();
  out.tool_triangles = scene.geometry.tool.triangles.size();
  out.backend = backend.name();
  out.device = backend.device();
  out.haptic_device = run.device.name();
  const auto profile_text = [](Profile profile) { return profile == Profile::kPaper ? "paper" : "refined"; };
  const auto law_text = [](LawKind law) { return law == LawKind::kPrinted ? "printed" : "corrected"; };
  out.profile = profile_text(run.scene.response.profile);
  out.law = law_text(Run::law_settings(run.scene).kind);
  for (const ProfileChange& change : run.frame.profile_changes()) {
    const bool back = change.profile == run.scene.response.profile;
    out.profile_changes.push_back(
        {change.tick, profile_text(change.profile),
         law_text(back ? Run::law_settings(run.scene).kind : Run::other_law(run.scene))});
  }
  out.ticks = run.tick.ticks();
  out.missed_ticks = run.timing.missed_ticks;
  out.lateness_us = percentiles(run.timing.lateness_ns, 1000);
  out.lateness_bins_us = bins(run.timing.lateness_ns, true, 1000);
  out.result_age_ticks = percentiles(run.tick.result_age(), 1);
  out.result_age_bins_ticks = bins(run.tick.result_age(), false, 1);
  out.frame_us = percentiles(run.frame.frame_ns(), 1000);
  for (std::size_t stage = 0; stage < kMaxStages; ++stage)
    if (run.tick.stages()[stage]) out.stages_reached.push_back(static_cast<int>(stage));
  out.areas_max = run.frame.areas_max();
  out.force_max_N = run.tick.force_max();
  out.torque_max_Nm = run.tick.torque_max();
  out.frames = run.frame.frames();
  out.no_direction_frames = run.frame.no_direction_frames();
  out.no_direction_tick = run.frame.no_direction_first().tick;
  out.no_direction_pose = run.frame.no_direction_first().pose;
  out.coarse_frames = run.frame.budget().coarse_frames();
  out.coarsest_share = std::exp2(-static_cast<double>(run.frame.budget().coarsest()) / 256);
  out.watchdog_ticks = run.device.watchdog_ticks();
  out.saturated_ticks = run.device.saturated_ticks();
  out.realtime = outlook(run, out);
  out.dropped_ticks = run.dropped_ticks;
  out.dropped_frames = run.dropped_frames;
  out.stopped = run.timing.stopped;
  out.plan_changes = run.frame.plan_changes();
  out.ignored_patches_first = run.frame.ignored_at_first();
  if (run.frame.frames() > 0)
    out.ignored_patches_end = run.frame.ignored() ? run.frame.ignored()->patches.size() : 0;
  out.failure = failure_of(run);

  const auto note = [&](std::string text) { out.notes.push_back(std::move(text)); };
  if (const SlowFrame& slowest = run.frame.slowest(); run.frame.slow_frames() > 0)
    note(std::to_string(run.frame.slow_frames()) + " of " + std::to_string(out.frames) +
         " frames took longer than the watchdog's " + number(run.scene.control.watchdog_ms) +
         " ms; the slowest, " + number(std::round(slowest.us / 100) / 10) + " ms at tick " +
         std::to_string(slowest.sample.tick) + " with the tool at " + position_text(slowest.sample.pose) +
         (*slowest.stage ? std::string(", spent most in stage ") + slowest.stage + ", " +
                               number(std::round(slowest.stage_us / 100) / 10) + " ms"
                         : std::string()));
  if (out.coarse_frames > 0)
    note(std::to_string(out.coarse_frames) + " of " + std::to_string(out.frames) +
         " frames were sampled coarser than their contact asks for, with " +
         number(std::floor(100 * out.coarsest_share)) +
         " % of the samples at the least, to take no longer than response.budget_us, " +
         number(run.scene.response.budget_us) + " µs");
  if (out.no_direction_frames > 0) {
    note(std::to_string(out.no_direction_frames) +
         (out.no_direction_frames > 1 ? " frames were" : " frame was") +
         " in touch where nothing tells the way out, as between open surfaces, and gave no force; "
         "the first at tick " +
         std::to_string(out.no_direction_tick) + ", the tool at " + position_text(out.no_direction_pose));
  }
  if (run.scene.start_contacts == StartContacts::kIgnoreInitial) {
    if (run.scene.response.profile == Profile::kPaper)
      note("\"start\": \"ignore_initial\" is for profile refined; in paper contacts of the start push");
    else if (out.ignored_patches_first > 0)
      note("contacts of the start were left out on " + std::to_string(out.ignored_patches_first) +
           (out.ignored_patches_first > 1 ? " faces" : " face") + " of the mock-up; " +
           (out.ignored_patches_end > 0
                ? "on " + std::to_string(out.ignored_patches_end) + " they had not opened by the end"
                : "all had opened by the end"));
  }
  if (std::string swing = swing_of_the_hand(run.scene, out.force_max_N); !swing.empty())
    note(std::move(swing));
  if (!run.realtime_note.empty()) note(run.realtime_note);
  for (std::string& sentence : backend.take_notes()) note(std::move(sentence));
  if (run.options.plans)
    for (std::string& sentence : run.options.plans->take_notes()) note(std::move(sentence));
  if (out.plan_changes > 0)
    note("the session went over to another plan " + std::to_string(out.plan_changes) +
         (out.plan_changes > 1 ? " times" : " time"));
  for (const SessionSummary::Changed& change : out.profile_changes)
    note("from tick " + std::to_string(change.tick) + " on it answered in profile " + change.profile +
         ", law " + change.law);
  if (out.stopped)
    note("the run was stopped after " + std::to_string(out.ticks) + " ticks" +
         (run.ticks == kForever ? "" : " of " + std::to_string(run.ticks)) + ", with zero force");
  if (out.watchdog_ticks > 0)
    note("results came more than " + number(run.scene.control.watchdog_ms) + " ms apart in " +
         std::to_string(out.watchdog_ticks) + " ticks: the watchdog faded the force out");
  if (const auto* told = dynamic_cast<const DeviceNotes*>(&device))
    for (std::string& sentence : told->notes()) note(std::move(sentence));
  if (run.tick.unready_ticks() > 0)
    note("the haptic device was not ready (unplugged, loading, homing) in " +
         std::to_string(run.tick.unready_ticks()) + " ticks, which had no force");
  if (out.missed_ticks > 0)
    note(std::to_string(out.missed_ticks) + (out.missed_ticks == 1 ? " tick was" : " ticks were") +
         " missed: the loop's thread did not get the processor in time");
  if (run.frame.truncated_frames() > 0)
    note(std::to_string(run.frame.truncated_frames()) +
         " frames gave no force because a capacity was too small: " + run.frame.truncated_capacity());
  if (run.frame.merged_frames() > 0)
    note(std::to_string(run.frame.merged_frames()) + " frames had more than " +
         std::to_string(kMaxLawPlanes) + " areas with force: the smallest were extrapolated as one");
  if (out.dropped_ticks > 0)
    note(std::to_string(out.dropped_ticks) + " ticks are missing from the recording: it fell behind");
  if (out.dropped_frames > 0)
    note(std::to_string(out.dropped_frames) +
         " frames are missing from the recording, which fell behind: charts of frames have gaps there");
  return out;
}

}  // namespace

Result<SessionSummary> run_session(const LoadedScene& scene, CollisionBackend& backend, HapticDevice& device,
                                   const SessionOptions& options, RunObserver* observer) {
  if (auto fine = check(scene.scene, options); !fine) return fine.error();
  if (auto finished = backend.finish_preparing(); !finished) return finished.error();
  const ControlSettings& control = scene.scene.control;
  SafetySettings safety;
  safety.fade_in_ticks = in_ticks(control.fade_in_ms);
  safety.watchdog_ticks = watchdog_ticks(scene.scene);
  safety.slew_ticks = control.slew_ms / 1000 / kTickSeconds;
  safety.passivity = control.passivity;
  // From here on every way out passes SafeDevice's destructor: zero force, then closed.
  SafeDevice safe(device, safety);
  if (auto opened = safe.open(); !opened) return opened.error();

  std::unique_ptr<Run> run;
  try {
    run = std::make_unique<Run>(scene, backend, safe, options, observer);
    if (options.pace == Pace::kAsap) {
      run_asap(*run);
    } else {
      run_realtime(*run);
    }
  } catch (const std::exception& error) {  // no memory, no thread
    return Error{ErrorCode::kInternal, std::string("the session can't run: ") + error.what()};
  }
  safe.close();

  return summarise(*run, scene, backend, device);
}

}  // namespace palpate

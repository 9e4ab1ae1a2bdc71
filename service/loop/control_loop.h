#pragma once
#include <array>
#include <atomic>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>

#include "driver/safe_device.h"
#include "service/loop/collision_frame.h"
#include "service/loop/force_law.h"
#include "service/loop/histogram.h"
#include "service/loop/run_record.h"
#include "service/loop/virtual_coupling.h"

namespace palpate {

inline constexpr std::size_t kMaxStages = 256;  ///< stages that a run can tell apart

/// One tick of control, the same in real and in virtual time: sense, then act on what is known. No clock, no
/// allocation, no lock, no exception.
class ControlTick {
 public:
  /// `device` outlives this. `tool_gc`: the tool's centre of mass in its own frame, m. A coupling goes with
  /// law `corrected` alone. `field`: whether the run begins with the coupling and the law of profile
  /// `refined` or with those of `paper`; later on each result says which. `other`: the other one's law;
  /// empty: the same.
  ControlTick(SafeDevice& device, const ForceLawSettings& law, const Vec3& tool_gc,
              const Couplings& couplings = {}, bool field = true, std::optional<LawKind> other = {});

  /// Reads the device. `tick` counts 1 ms periods since the start, missed ones too. Returns where the tool
  /// is: where the device is, or, with a virtual coupling, where it hangs; that pose is the one to ask about.
  PoseSample sense(std::int64_t tick) noexcept;
  /// Force law, gate and limits, and out; `fresh` is the newest result, or null if there is no new one.
  const TickRecord& act(const LawResult* fresh) noexcept;

  /// Real time: how punctual the tick that follows is; recorded, decides nothing.
  void note_timing(std::int64_t late_ns, std::uint64_t missed_ticks) noexcept {
    record_.lateness_us = static_cast<float>(late_ns) / 1000;
    record_.missed_ticks = missed_ticks;
  }

  bool device_failed() const noexcept { return device_.faulted(); }
  std::uint64_t ticks() const { return ticks_; }
  /// In which the device was opening, loading, homing or at fault.
  std::uint64_t unready_ticks() const { return unready_ticks_; }
  const Histogram& result_age() const { return result_age_; }
  const std::array<bool, kMaxStages>& stages() const { return stages_; }
  double force_max() const { return force_max_; }    ///< N, sent
  double torque_max() const { return torque_max_; }  ///< N·m, sent

 private:
  void take_profile(bool field) noexcept;

  SafeDevice& device_;
  ForceLawSettings settings_;
  LawKind other_;  ///< the law of the profile that is not in use
  ForceLawState law_;
  Couplings couplings_;
  VirtualCoupling coupling_;
  bool coupled_ = false, field_ = true;
  Vec3 tool_gc_;
  LawPose pose_;       ///< of the tool
  Vec3 device_gc_{0};  ///< where the tool would be without a coupling
  TickRecord record_;
  std::int64_t result_tick_ = -1;
  std::uint32_t change_ = 0;  ///< of the newest result
  std::uint64_t ticks_ = 0, unready_ticks_ = 0;
  Histogram result_age_;
  std::array<bool, kMaxStages> stages_{};
  double force_max_ = 0, torque_max_ = 0;
};

/// What the real-time loop and the session share. The loop's thread looks at `stop` and `abort` every tick.
struct LoopSignals {
  const std::atomic<bool>* stop = nullptr;  ///< from outside, may be null
  std::atomic<bool> abort{false};           ///< another part of the session has failed
  std::atomic<bool> done{false};            ///< set by the loop when the device is at zero force and closed
};

/// How a real-time loop kept its time.
struct LoopTiming {
  Histogram lateness_ns;           ///< wake-up after the scheduled time
  std::uint64_t missed_ticks = 0;  ///< whole periods skipped because a tick came too late
  bool stopped = false;            ///< by `stop`
};

class CollisionWorker;

/// Where the loop's records go; false: full, the record is dropped. Wait-free.
using TickSink = bool (*)(void* context, const TickRecord& record) noexcept;

/// Runs the calling thread as the 1 kHz loop until `ticks` are done (executed ones), `stop` or `abort` is
/// set, the worker or the device fails. Then, whatever the reason, sends zero force, closes the device and
/// sets `done`. Sleeps to absolute times; a tick that comes a whole period late is skipped, never caught up
/// in a burst. Returns how many records the sink refused.
std::uint64_t run_realtime_loop(ControlTick& tick, SafeDevice& device, CollisionWorker& worker,
                                std::uint64_t ticks, LoopSignals& signals, LoopTiming& timing, TickSink sink,
                                void* sink_context) noexcept;

struct RealtimeGrant {
  bool locked = false;  ///< mlockall was granted; munlockall() takes it back
  std::string refused;  ///< a sentence on what was refused; empty: nothing
};

/// Of SCHED_FIFO: above what a desktop uses, below the kernel's own threads (chosen).
inline constexpr int kLoopPriority = 80;

/// Asks for SCHED_FIFO for the calling thread, for a processor of its own (loop_processor, so that it isn't
/// moved about), and for the process's present pages to stay in memory.
RealtimeGrant make_realtime();

/// Whether SCHED_FIFO would be granted. Leaves the thread as it was.
bool may_be_realtime();

}  // namespace palpate

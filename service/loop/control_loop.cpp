#include "service/loop/control_loop.h"

#include <pthread.h>
#include <sched.h>
#include <sys/mman.h>
#include <time.h>

#include <algorithm>
#include <cerrno>
#include <cstring>
#include <glm/geometric.hpp>
#include <utility>

#include "service/loop/collision_worker.h"
#include "service/loop/thread_share.h"

namespace palpate {
namespace {

constexpr std::int64_t kPeriodNs = 1'000'000;

std::int64_t now_ns() noexcept {
  timespec t{};
  clock_gettime(CLOCK_MONOTONIC, &t);
  return std::int64_t{t.tv_sec} * 1'000'000'000 + t.tv_nsec;
}

void sleep_until(std::int64_t ns) noexcept {
  const timespec t{.tv_sec = ns / 1'000'000'000, .tv_nsec = ns % 1'000'000'000};
  while (clock_nanosleep(CLOCK_MONOTONIC, TIMER_ABSTIME, &t, nullptr) == EINTR) {
  }
}

}  // namespace

ControlTick::ControlTick(SafeDevice& device, const ForceLawSettings& law, const Vec3& tool_gc,
                         const Couplings& couplings, bool field, std::optional<LawKind> other)
    : device_(device),
      settings_(law),
      other_(other.value_or(law.kind)),
      law_(law),
      couplings_(couplings),
      coupling_({}),
      field_(field),
      tool_gc_(tool_gc) {
  take_profile(field);
}

/// Takes the law and the springs that go with the profile. Where nothing reaches the device but by a spring,
/// the spring keeps the force from jumping, and the law need not.
void ControlTick::take_profile(bool field) noexcept {
  if (field != field_ && other_ != settings_.kind) {
    std::swap(other_, settings_.kind);
    law_ = ForceLawState(settings_);
  }
  field_ = field;
  coupling_ = VirtualCoupling(field ? couplings_.field : couplings_.areas, settings_.change_n_per_s);
  coupled_ = coupling_.on() && settings_.kind == LawKind::kCorrected;
  law_.limit_change(coupled_ && coupling_.all() ? 0 : settings_.change_n_per_s);
}

PoseSample ControlTick::sense(std::int64_t tick) noexcept {
  const DeviceSample sample = device_.read();
  record_.tick = static_cast<std::int64_t>(ticks_);
  record_.time_s = static_cast<double>(tick) / 1000;
  record_.pose = sample.pose;
  record_.stage = sample.stage;
  record_.ready = sample.state == DeviceState::kReady;
  record_.paused = sample.paused;
  record_.guidance = device_.guidance();
  if (!record_.ready) ++unready_ticks_;
  if (sample.stage > 0 && static_cast<std::size_t>(sample.stage) < kMaxStages)
    stages_[static_cast<std::size_t>(sample.stage)] = true;
  device_gc_ = sample.pose.position + sample.pose.rotation * tool_gc_;
  pose_ = {tick, device_gc_, sample.pose.rotation};
  if (!coupled_) return {tick, sample.pose};
  pose_ = coupling_.follow(law_, pose_);
  return {tick, {pose_.gc - pose_.rotation * tool_gc_, pose_.rotation}};
}

const TickRecord& ControlTick::act(const LawResult* fresh) noexcept {
  if (fresh != nullptr && fresh->field != field_) {
    device_.restart_fade();  // another law and another spring: from zero force
    take_profile(fresh->field);
  }
  Wrench wrench = law_.step(pose_, fresh);
  if (law_.jumped()) {  // the device homed, or slipped
    device_.restart_fade();
    coupling_.reset();
  }
  if (law_.took_fresh()) {
    device_.fresh();
    result_tick_ = fresh->tick;
    if (fresh->change != change_)
      device_.restart_fade();  // another profile or device: nothing is as it was felt
    change_ = fresh->change;
    record_.response = fresh->wrench;
    record_.contact = fresh->contact;
  }
  if (coupled_) wrench = coupling_.force(wrench);
  device_.write(wrench, device_gc_);
  record_.sent = device_.sent();
  record_.uncontrolled = device_.exertable(record_.response, device_gc_);
  record_.result_age_ticks = result_tick_ < 0 ? -1 : static_cast<std::int32_t>(pose_.tick - result_tick_);

  ++ticks_;
  if (result_tick_ >= 0) result_age_.add(record_.result_age_ticks);
  force_max_ = std::max(force_max_, glm::length(record_.sent.force));
  torque_max_ = std::max(torque_max_, glm::length(record_.sent.torque));
  return record_;
}

std::uint64_t run_realtime_loop(ControlTick& tick, SafeDevice& device, CollisionWorker& worker,
                                std::uint64_t ticks, LoopSignals& signals, LoopTiming& timing, TickSink sink,
                                void* sink_context) noexcept {
  std::uint64_t dropped = 0;
  std::int64_t period = 0;  // grid index of this tick
  const std::int64_t start = now_ns();
  while (tick.ticks() < ticks) {
    if (signals.stop && signals.stop->load(std::memory_order_relaxed)) {
      timing.stopped = true;
      break;
    }
    if (signals.abort.load(std::memory_order_relaxed) || worker.failed() || tick.device_failed()) break;

    worker.submit(tick.sense(period));
    if (!sink(sink_context, tick.act(worker.take_result()))) ++dropped;

    ++period;
    sleep_until(start + period * kPeriodNs);
    const std::int64_t late = std::max<std::int64_t>(now_ns() - (start + period * kPeriodNs), 0);
    timing.lateness_ns.add(late);
    if (const std::int64_t skipped = late / kPeriodNs; skipped > 0) {
      timing.missed_ticks += static_cast<std::uint64_t>(skipped);
      period += skipped;
    }
    tick.note_timing(late, timing.missed_ticks);
  }
  device.close();  // zero force first
  signals.done.store(true, std::memory_order_release);
  return dropped;
}

namespace {

/// 0, or why the calling thread couldn't be bound to one processor.
int bind_to(int processor) {
  cpu_set_t one{};
  CPU_SET(static_cast<std::size_t>(processor), &one);
  return pthread_setaffinity_np(pthread_self(), sizeof(one), &one);
}

}  // namespace

RealtimeGrant make_realtime() {
  RealtimeGrant grant;
  const auto refuse = [&](std::string what, int error, const char* so) {
    grant.refused +=
        (grant.refused.empty() ? "" : "; ") + std::move(what) + " (" + std::strerror(error) + ")" + so;
  };
  set_exact_sleep();
  const sched_param priority{.sched_priority = kLoopPriority};
  if (const int error = pthread_setschedparam(pthread_self(), SCHED_FIFO, &priority); error != 0) {
    refuse("no real-time priority", error, ": ticks are as punctual as the ordinary scheduler makes them");
    set_slice(kSliceTickUs);
  }
  if (const int processor = loop_processor(); processor >= 0)
    if (const int unbound = bind_to(processor); unbound != 0)
      refuse("the loop isn't bound to a processor", unbound, "");
  grant.locked = mlockall(MCL_CURRENT | MCL_ONFAULT) == 0;
  if (!grant.locked) refuse("memory isn't locked", errno, "");
  return grant;
}

bool may_be_realtime() {
  int policy = 0;
  sched_param before{};
  if (pthread_getschedparam(pthread_self(), &policy, &before) != 0) return false;
  const sched_param wanted{.sched_priority = kLoopPriority};
  if (pthread_setschedparam(pthread_self(), SCHED_FIFO, &wanted) != 0) return false;
  pthread_setschedparam(pthread_self(), policy, &before);
  return true;
}

}  // namespace palpate

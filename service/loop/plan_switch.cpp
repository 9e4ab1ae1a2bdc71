#include "service/loop/plan_switch.h"

#include <exception>
#include <utility>

namespace palpate {

PlanSwitch::PlanSwitch(const SceneGeometry& geometry, std::unique_ptr<CollisionBackend> other)
    : geometry_(geometry), other_(std::move(other)), spare_(other_.get()) {}

PlanSwitch::~PlanSwitch() {
  if (!thread_.joinable()) return;
  {
    const std::lock_guard lock(mutex_);
    stop_ = true;
  }
  wake_.notify_one();
  thread_.join();
}

void PlanSwitch::request(const PlanTarget& target) {
  const std::lock_guard lock(mutex_);
  wanted_ = target;
  if (!thread_.joinable()) thread_ = std::thread([this] { run(); });
  wake_.notify_one();
}

void PlanSwitch::prepare_now(const PlanTarget& target) { prepare(target); }

void PlanSwitch::run() {
  for (;;) {
    PlanTarget target;
    {
      std::unique_lock lock(mutex_);
      wake_.wait(lock, [this] { return stop_ || wanted_; });
      if (stop_) return;
      target = *std::exchange(wanted_, std::nullopt);
    }
    prepare(target);
  }
}

void PlanSwitch::prepare(const PlanTarget& target) {
  // What is ready and not taken yet is taken back. The worker that is just taking it needs a few instructions
  // more.
  for (int state = state_.load(std::memory_order_acquire);;) {
    if (state == kTaking) {
      std::this_thread::yield();
      state = state_.load(std::memory_order_acquire);
    } else if (state_.compare_exchange_weak(state, kPreparing, std::memory_order_acq_rel)) {
      break;
    }
  }
  const auto stopped = [this] {
    const std::lock_guard lock(mutex_);
    return stop_;
  };
  Result<void> prepared = Error{ErrorCode::kInternal, ""};
  try {
    prepared = spare_->prepare(geometry_, target.plan, [&](const char*, double) { return !stopped(); });
    if (prepared) prepared = spare_->finish_preparing();
  } catch (const std::exception& failure) {
    prepared = Error{ErrorCode::kInternal, failure.what()};
  }
  if (!prepared) {
    const std::lock_guard lock(mutex_);
    if (!stop_)
      notes_.push_back("the session kept its plan, for another could not be prepared: " +
                       prepared.error().sentence);
    state_.store(kIdle, std::memory_order_release);
    return;
  }
  ready_ = target;
  state_.store(kReady, std::memory_order_release);
}

std::vector<std::string> PlanSwitch::take_notes() {
  const std::lock_guard lock(mutex_);
  return std::exchange(notes_, {});
}

const PlanTarget* PlanSwitch::take(CollisionBackend*& backend) noexcept {
  int ready = kReady;
  if (!state_.compare_exchange_strong(ready, kTaking, std::memory_order_acq_rel)) return nullptr;
  taken_ = ready_;
  std::swap(backend, spare_);
  state_.store(kIdle, std::memory_order_release);
  return &taken_;
}

}  // namespace palpate

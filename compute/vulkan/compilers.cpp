#include "compute/vulkan/compilers.h"

#include <algorithm>
#include <condition_variable>
#include <deque>
#include <mutex>
#include <thread>
#include <utility>

#include "model/processors.h"

namespace palpate {

struct Compilers::State {
  std::mutex mutex;
  std::condition_variable idle;
  std::deque<std::function<void()>> jobs;
  unsigned threads = 0;
  bool held = false;

  static void take_thread(const std::shared_ptr<State>& state);
};

Compilers::Compilers() : state_(std::make_shared<State>()) {}

Compilers::~Compilers() {
  std::unique_lock lock(state_->mutex);
  state_->jobs.clear();
  state_->idle.wait(lock, [this] { return state_->threads == 0; });
}

/// With the lock held.
void Compilers::State::take_thread(const std::shared_ptr<State>& state) {
  static const unsigned kMostThreads = std::clamp(processors(), 1u, 8u);  // chosen
  if (state->threads == kMostThreads) return;
  ++state->threads;
  std::thread([state] {
    std::unique_lock inner(state->mutex);
    while (!state->jobs.empty()) {
      const std::function<void()> next = std::move(state->jobs.front());
      state->jobs.pop_front();
      inner.unlock();
      next();
      inner.lock();
    }
    if (--state->threads == 0) state->idle.notify_all();
  }).detach();
}

void Compilers::add(std::function<void()> job) {
  const std::lock_guard lock(state_->mutex);
  state_->jobs.push_back(std::move(job));
  if (!state_->held) State::take_thread(state_);
}

void Compilers::hold() {
  const std::lock_guard lock(state_->mutex);
  state_->held = true;
}

void Compilers::begin() {
  const std::lock_guard lock(state_->mutex);
  if (!std::exchange(state_->held, false)) return;
  for (std::size_t i = 0; i < state_->jobs.size(); ++i) State::take_thread(state_);
}

}  // namespace palpate

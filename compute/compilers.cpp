#include "compute/compilers.h"

#include <algorithm>
#include <condition_variable>
#include <deque>
#include <mutex>
#include <thread>

namespace palpate {

struct Compilers::State {
  std::mutex mutex;
  std::condition_variable idle;
  std::deque<std::function<void()>> jobs;
  unsigned threads = 0;
};

Compilers::Compilers() : state_(std::make_shared<State>()) {}

Compilers::~Compilers() {
  std::unique_lock lock(state_->mutex);
  state_->jobs.clear();
  state_->idle.wait(lock, [this] { return state_->threads == 0; });
}

void Compilers::add(std::function<void()> job) {
  static const unsigned kMostThreads = std::clamp(std::thread::hardware_concurrency(), 1u, 8u);   // chosen
  const std::lock_guard lock(state_->mutex);
  state_->jobs.push_back(std::move(job));
  if (state_->threads == kMostThreads) return;
  ++state_->threads;
  std::thread([state = state_] {
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

}  // namespace palpate

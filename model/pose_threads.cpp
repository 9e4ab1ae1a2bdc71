#include "model/pose_threads.h"

#include <algorithm>
#include <new>
#include <system_error>
#include <utility>

namespace palpate {
namespace {

constexpr std::size_t kMostAtOnce =
    8;  // pieces that a thread takes at a time (chosen: less handing over; few, so that all end together)

}  // namespace

PoseThreads::PoseThreads(std::vector<PoseQuery*> helpers) : helpers_(std::move(helpers)) {
  threads_.reserve(helpers_.size());
  for (PoseQuery* helper : helpers_) {
    try {
      threads_.emplace_back([this, helper] { serve(*helper); });
    } catch (const std::system_error&) {
      return;  // those that can't be had are done without
    }
  }
}

PoseThreads::~PoseThreads() {
  {
    const std::lock_guard lock(mutex_);
    stop_ = true;
  }
  begun_.notify_all();
  for (std::thread& thread : threads_) thread.join();
}

/// Takes pieces until none is left.
void PoseThreads::take(PoseQuery& asked) {
  const std::size_t threads = threads_.size() + 1;
  for (;;) {
    std::size_t first = 0, last = 0;
    {
      const std::lock_guard lock(mutex_);
      if (next_ == count_) return;
      first = next_;
      last = next_ += std::clamp<std::size_t>((count_ - next_) / (2 * threads), 1, kMostAtOnce);
    }
    for (std::size_t i = first; i < last; ++i) {
      Result<void> answered = Error{ErrorCode::kInternal, "there was no memory left for a pose of a batch"};
      try {
        answered = (*work_)(asked, i);
      } catch (const std::bad_alloc&) {  // must not end a helper's thread, and the program with it
      }
      if (answered) continue;
      const std::lock_guard lock(mutex_);
      if (outcome_) outcome_ = std::move(answered);
      next_ = count_;
      return;
    }
  }
}

void PoseThreads::serve(PoseQuery& asked) {
  std::uint64_t seen = 0;
  std::unique_lock lock(mutex_);
  for (;;) {
    begun_.wait(lock, [&] { return stop_ || round_ != seen; });
    if (stop_) return;
    seen = round_;
    lock.unlock();
    take(asked);
    lock.lock();
    if (--busy_ == 0) finished_.notify_one();
  }
}

Result<void> PoseThreads::share(PoseQuery& own, std::size_t count, const PoseWork& work) {
  {
    const std::lock_guard lock(mutex_);
    work_ = &work;
    count_ = count;
    next_ = 0;
    outcome_ = {};
    busy_ = threads_.size();
    ++round_;
  }
  begun_.notify_all();
  take(own);
  std::unique_lock lock(mutex_);
  finished_.wait(lock, [&] { return busy_ == 0; });
  return outcome_;
}

}  // namespace palpate

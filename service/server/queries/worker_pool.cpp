#include "service/server/queries/worker_pool.h"

#include <utility>

namespace palpate {

WorkerPool::WorkerPool(int threads) {
  for (int i = 0; i < threads; ++i) threads_.emplace_back([this] { run(); });
}

WorkerPool::~WorkerPool() {
  {
    const std::lock_guard lock(mutex_);
    stop_ = true;
  }
  work_.notify_all();
  for (std::thread& thread : threads_) thread.join();
}

void WorkerPool::after(double seconds, std::function<void()> task) {
  {
    const std::lock_guard lock(mutex_);
    tasks_.emplace(
        Clock::now() + std::chrono::duration_cast<Clock::duration>(std::chrono::duration<double>(seconds)),
        std::move(task));
  }
  work_.notify_one();
}

void WorkerPool::run() {
  std::unique_lock lock(mutex_);
  while (!stop_) {
    if (tasks_.empty()) {
      work_.wait(lock);
      continue;
    }
    const auto due = tasks_.begin()->first;
    if (due > Clock::now()) {
      work_.wait_until(lock, due);
      continue;
    }
    {
      const std::function<void()> task = std::move(tasks_.begin()->second);
      tasks_.erase(tasks_.begin());
      lock.unlock();
      task();
    }  // what the task holds is given back before the lock is taken: it may post
    lock.lock();
  }
}

}  // namespace palpate

#pragma once
#include <condition_variable>
#include <cstdint>
#include <mutex>
#include <thread>
#include <vector>

#include "model/collision_backend.h"
#include "model/result.h"

namespace palpate {

/// Poses of all batches from which on threads are set up for them (chosen).
inline constexpr std::size_t kWorthThreads = 128;

/// Threads that work on poses beside the caller's, each with somebody of its own to ask. One caller at a
/// time.
class PoseThreads {
 public:
  /// A thread for each of `helpers`, as far as threads can be had. They outlive this.
  explicit PoseThreads(std::vector<PoseQuery*> helpers);
  ~PoseThreads();
  PoseThreads(const PoseThreads&) = delete;
  PoseThreads& operator=(const PoseThreads&) = delete;

  /// As CollisionBackend::share: this thread asks `own`, each other thread its helper. After an error, what
  /// nobody has begun is not done.
  Result<void> share(PoseQuery& own, std::size_t count, const PoseWork& work);

 private:
  void take(PoseQuery& asked);
  void serve(PoseQuery& asked);

  std::vector<PoseQuery*> helpers_;
  std::mutex mutex_;
  std::condition_variable begun_, finished_;
  bool stop_ = false;
  std::uint64_t round_ = 0;  ///< calls of share()
  std::size_t busy_ = 0;     ///< helpers at work on it
  const PoseWork* work_ = nullptr;
  std::size_t count_ = 0, next_ = 0;
  Result<void> outcome_;
  std::vector<std::thread> threads_;
};

}  // namespace palpate

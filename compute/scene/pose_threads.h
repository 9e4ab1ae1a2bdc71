#pragma once
#include <condition_variable>
#include <cstdint>
#include <functional>
#include <mutex>
#include <span>
#include <thread>
#include <vector>

#include "model/contacts.h"
#include "model/lattice.h"
#include "model/result.h"

namespace palpate {

/// Threads that answer poses of a batch beside the caller's, each in its own way: with a frame of its own. One caller at a time.
class PoseThreads {
 public:
  using Answer = std::function<Result<void>(const LatticePose& pose, Contacts& out)>;
  /// A thread for each of `helpers`, as far as threads can be had. What they refer to outlives this.
  explicit PoseThreads(std::vector<Answer> helpers);
  ~PoseThreads();
  PoseThreads(const PoseThreads&) = delete;
  PoseThreads& operator=(const PoseThreads&) = delete;

  /// Answers all poses: by `own` on this thread, by the helpers beside it. After an error, poses that nobody has begun are not answered.
  Result<void> answer(const Answer& own, std::span<const LatticePose> poses, std::span<Contacts> out);

 private:
  void work(const Answer& by);
  void serve(const Answer& by);

  std::vector<Answer> helpers_;
  std::mutex mutex_;
  std::condition_variable begun_, finished_;
  bool stop_ = false;
  std::uint64_t round_ = 0;       ///< batches begun
  std::size_t busy_ = 0;          ///< helpers at work on it
  std::span<const LatticePose> poses_;
  std::span<Contacts> out_;
  std::size_t next_ = 0;
  Result<void> outcome_;
  std::vector<std::thread> threads_;
};

}  // namespace palpate

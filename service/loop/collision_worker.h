#pragma once
#include <atomic>
#include <cstdint>
#include <memory>
#include <optional>
#include <thread>

#include "model/latest_value.h"
#include "model/result.h"
#include "service/loop/collision_frame.h"

namespace palpate {

/// Collision detection and response on a thread of its own, in real time: always the newest pose, as fast as
/// it goes. The control loop talks to it through two mailboxes and a flag, and never waits for it. Answered
/// frames go to a bounded queue; when the recording side is behind, a frame is not recorded and counted, but
/// never waited for.
class CollisionWorker {
 public:
  /// `frame` outlives the worker and is used by its thread alone while it runs.
  explicit CollisionWorker(CollisionFrame& frame);
  ~CollisionWorker();  ///< stops

  void start();
  /// Ends the thread after the query under way; waits for it. Force must be off by then.
  void stop() noexcept;

  // --- control loop's side: wait-free but for the wake-up of a sleeping worker, which is one futex call
  void submit(const PoseSample& sample) noexcept;
  const LawResult* take_result() noexcept { return results_.take(); }
  bool failed() const noexcept { return failed_.load(std::memory_order_acquire); }

  // --- recording side, one thread
  /// The oldest answered frame not recorded yet, or null. Give it back with release() before the next.
  FrameSlot* next_frame();
  void release(FrameSlot* slot);

  // --- after stop()
  const std::optional<Error>& error() const { return error_; }
  std::uint64_t dropped_frames() const { return dropped_frames_; }

 private:
  struct Queues;
  void run() noexcept;

  CollisionFrame& frame_;
  LatestValue<PoseSample> poses_;
  LatestValue<LawResult> results_;
  std::unique_ptr<Queues> queues_;
  std::atomic<std::uint32_t> submitted_{0};
  std::atomic<bool> stop_{false}, failed_{false};
  std::optional<Error> error_;
  std::uint64_t dropped_frames_ = 0;
  std::thread thread_;
};

}  // namespace palpate

#include "service/loop/collision_worker.h"

#include <array>
#include <boost/lockfree/spsc_queue.hpp>
#include <cstddef>

#include "service/loop/control_loop.h"
#include "service/loop/thread_share.h"

namespace palpate {
namespace {

constexpr std::size_t kFrameSlots =
    64;  ///< 64 ms of 1 ms frames; the recording thread looks every few ms (chosen)

}  // namespace

/// Slots go round: free → worker fills → filled → recorder writes → free.
struct CollisionWorker::Queues {
  std::array<FrameSlot, kFrameSlots> slots;
  FrameSlot spare;  ///< for a frame that nobody records
  boost::lockfree::spsc_queue<FrameSlot*, boost::lockfree::capacity<kFrameSlots>> free, filled;
};

CollisionWorker::CollisionWorker(CollisionFrame& frame) : frame_(frame), queues_(std::make_unique<Queues>()) {
  for (FrameSlot& slot : queues_->slots) queues_->free.push(&slot);
}

CollisionWorker::~CollisionWorker() { stop(); }

void CollisionWorker::start() {
  thread_ = std::thread([this] { run(); });
}

void CollisionWorker::stop() noexcept {
  if (!thread_.joinable()) return;
  stop_.store(true, std::memory_order_release);
  submitted_.fetch_add(1, std::memory_order_release);
  submitted_.notify_one();
  thread_.join();
}

void CollisionWorker::submit(const PoseSample& sample) noexcept {
  poses_.publish(sample);
  submitted_.fetch_add(1, std::memory_order_release);
  submitted_.notify_one();
}

FrameSlot* CollisionWorker::next_frame() {
  FrameSlot* slot = nullptr;
  queues_->filled.pop(slot);
  return slot;
}

void CollisionWorker::release(FrameSlot* slot) { queues_->free.push(slot); }

void CollisionWorker::run() noexcept {
  // It shares the loop's processor, on which nobody else of this process runs: beside those who answer
  // batches it would wait for milliseconds.
  const ForHand for_hand;
  set_nice(kNiceContact);
  set_slice(may_be_realtime() ? kSliceContactUs : kSliceBesideLoopUs);
  LawResult result;
  std::uint64_t dropped_before = 0;  // up to the last record
  std::uint32_t seen = 0;
  while (!stop_.load(std::memory_order_acquire)) {
    // The count is read before the mailbox, so a pose that comes in between ends the wait at once.
    const std::uint32_t count = submitted_.load(std::memory_order_acquire);
    const PoseSample* sample = poses_.take();
    if (!sample) {
      if (count == seen) submitted_.wait(count, std::memory_order_acquire);
      seen = count;
      continue;
    }
    FrameSlot* slot = &queues_->spare;
    const bool recorded = queues_->free.pop(slot);
    slot->sample = *sample;
    if (auto solved = frame_.solve(*slot, result); !solved) {
      error_ = solved.error();
      failed_.store(true, std::memory_order_release);
      return;
    }
    results_.publish(result);
    if (recorded) {
      slot->after_gap = dropped_frames_ != dropped_before;
      dropped_before = dropped_frames_;
      queues_->filled.push(slot);
    } else {
      ++dropped_frames_;
    }
  }
}

}  // namespace palpate

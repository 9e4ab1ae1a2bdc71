#include "service/server/queries/turns.h"

namespace palpate {

void Turns::enter_loop() {
  std::unique_lock lock(mutex_);
  const std::uint64_t ticket = tail_++;
  loops_.wait(lock,
              [&] { return !busy_ && ticket == head_ && !(batches_waiting_ > 0 && passed_ >= kLoopTurns); });
  ++head_;
  if (batches_waiting_ > 0) ++passed_;
  busy_ = true;
}

void Turns::enter_batch() {
  std::unique_lock lock(mutex_);
  if (batches_waiting_++ == 0) passed_ = 0;
  batches_.wait(lock, [&] { return !busy_ && (head_ == tail_ || passed_ >= kLoopTurns); });
  --batches_waiting_;
  passed_ = 0;
  busy_ = true;
}

void Turns::leave() {
  {
    const std::lock_guard lock(mutex_);
    busy_ = false;
  }
  loops_.notify_all();    // a few at most; each looks whether it is its turn
  batches_.notify_one();  // which of them is all the same
}

}  // namespace palpate

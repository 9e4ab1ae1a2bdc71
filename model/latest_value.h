#pragma once
#include <array>
#include <atomic>
#include <cstdint>
#include <type_traits>

namespace palpate {

/// A mailbox that keeps the newest value only: one thread publishes, another takes, neither ever waits for
/// the other. Three slots: the writer's, the reader's, and one between that either swaps with its own in a
/// single atomic exchange, so nobody sees a slot half written. Wait-free, never allocates.
template <class T>
class LatestValue {
  static_assert(std::is_trivially_copyable_v<T>, "values are copied, a copy must not allocate");
  static_assert(std::atomic<std::uint8_t>::is_always_lock_free);

 public:
  /// Writer's thread only.
  void publish(const T& value) noexcept {
    slots_[writers_] = value;
    writers_ =
        between_.exchange(static_cast<std::uint8_t>(writers_ | kNew), std::memory_order_acq_rel) & kSlot;
  }

  /// Reader's thread only. The newest value if it has not been taken yet, else null. It stays as it is until
  /// the next call.
  const T* take() noexcept {
    if ((between_.load(std::memory_order_relaxed) & kNew) == 0) return nullptr;
    readers_ = between_.exchange(readers_, std::memory_order_acq_rel) & kSlot;
    return &slots_[readers_];
  }

 private:
  static constexpr std::uint8_t kSlot = 3, kNew = 4;

  std::array<T, 3> slots_{};
  // Each on its own cache line, lest the two loops slow each other down.
  alignas(64) std::atomic<std::uint8_t> between_{1};
  alignas(64) std::uint8_t writers_ = 0;
  alignas(64) std::uint8_t readers_ = 2;
};

}  // namespace palpate

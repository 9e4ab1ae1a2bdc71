#include "compute/native/frame_helper.h"

#include <system_error>
#include <utility>

#include "model/processors.h"

namespace palpate {
namespace {

constexpr int kSpins =
    1000;  // some 20 to 50 us: the next shared stage of a frame mostly begins before (chosen)

inline void pause() {
#if defined(__x86_64__)
  __builtin_ia32_pause();
#endif
}

constexpr std::uint64_t kRound = std::uint64_t{1} << 32;
constexpr std::uint64_t kEnd = std::uint64_t{1} << 16;
std::uint32_t end_of(std::uint64_t state) { return static_cast<std::uint32_t>(state >> 16 & 0xFFFF); }
std::uint32_t next_of(std::uint64_t state) { return static_cast<std::uint32_t>(state & 0xFFFF); }

}  // namespace

std::unique_ptr<FrameHelper> FrameHelper::make() {
  if (processors() < 2) return nullptr;
  std::unique_ptr<FrameHelper> out(new FrameHelper);
  try {
    out->thread_ = std::thread([helper = out.get()] { helper->serve(); });
  } catch (const std::system_error&) {
    return nullptr;
  }
  return out;
}

FrameHelper::~FrameHelper() {
  if (!thread_.joinable()) return;
  stop_.store(true, std::memory_order_release);
  bell_.fetch_add(1, std::memory_order_release);
  bell_.notify_one();
  thread_.join();
}

/// Takes parts until none is left, the asker from the first on, the helper from the last. A part that was
/// taken keeps its round from ending, and with it call_ and context_ as they are.
void FrameHelper::take_parts(int lane) noexcept {
  std::uint64_t state = left_.load(std::memory_order_acquire);
  while (next_of(state) < end_of(state)) {
    const std::uint64_t after = lane == 0 ? state + 1 : state - kEnd;
    if (!left_.compare_exchange_weak(state, after, std::memory_order_acq_rel, std::memory_order_acquire))
      continue;
    try {
      call_(context_, lane == 0 ? next_of(state) : end_of(after), lane);
    } catch (...) {  // no memory
      thrown_[static_cast<std::size_t>(lane)] = std::current_exception();
    }
    done_.fetch_add(1, std::memory_order_release);
    state = left_.load(std::memory_order_acquire);
  }
}

void FrameHelper::run(std::uint32_t parts, Call call, void* context) {
  call_ = call;
  context_ = context;
  done_.store(0, std::memory_order_relaxed);
  const std::uint64_t round = (left_.load(std::memory_order_relaxed) / kRound + 1) * kRound;
  left_.store(round | parts * kEnd, std::memory_order_release);
  bell_.fetch_add(1, std::memory_order_release);
  bell_.notify_one();
  take_parts(0);
  // A helper that is still at its part after so long may have lost its processor to others: spinning on would
  // keep it from coming back. Where nobody waits for this one, yielding is as quick.
  for (int spin = 0; done_.load(std::memory_order_acquire) != parts; ++spin)
    if (spin < kSpins)
      pause();
    else
      std::this_thread::yield();
  for (std::exception_ptr& thrown : thrown_)
    if (thrown) std::rethrow_exception(std::exchange(thrown, nullptr));
}

void FrameHelper::serve() {
  std::uint32_t seen = 0;
  while (!stop_.load(std::memory_order_acquire)) {
    std::uint32_t now = bell_.load(std::memory_order_acquire);
    for (int spin = 0; now == seen && spin < kSpins; ++spin) {
      pause();
      now = bell_.load(std::memory_order_acquire);
    }
    if (now == seen) {
      bell_.wait(seen, std::memory_order_acquire);
      continue;
    }
    seen = now;
    take_parts(1);
  }
}

}  // namespace palpate

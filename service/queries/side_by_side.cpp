#include "service/queries/side_by_side.h"

#include <algorithm>
#include <atomic>
#include <mutex>
#include <new>
#include <system_error>
#include <thread>

#include "model/processors.h"
#include "model/shared_backend.h"

namespace palpate {

Result<std::size_t> side_by_side(CollisionBackend& own, std::span<CollisionBackend* const> others,
                                 std::size_t count, const BackendWork& work, const GoOn& go_on) {
  std::atomic<std::size_t> next{0};
  std::atomic<bool> end{false};
  std::mutex mutex;
  Result<void> outcome;
  const auto serve = [&](CollisionBackend& backend, bool looks) {
    while (!end) {
      if (const std::size_t begun = next; begun < count && looks && !go_on(begun)) break;
      const std::size_t i = next.fetch_add(1);
      if (i >= count) return;
      Result<void> done;
      try {
        done = work(backend, i);
      } catch (const std::bad_alloc&) {  // a thread of ours must not end the program
        done = Error{ErrorCode::kInternal, "there was no memory left for a pose"};
      }
      if (done) continue;
      const std::lock_guard lock(mutex);
      if (outcome) outcome = std::move(done);
      end = true;
    }
    end = true;
  };
  std::vector<std::thread> threads;
  threads.reserve(others.size());
  try {
    for (CollisionBackend* const other : others) threads.emplace_back([&, other] { serve(*other, false); });
  } catch (const std::system_error&) {  // done without
  }
  serve(own, true);
  for (std::thread& thread : threads) thread.join();
  if (!outcome) return outcome.error();
  return std::min(next.load(), count);  // what was begun has been done
}

Result<std::size_t> Fellows::ask(std::size_t count, const BackendWork& work, const GoOn& go_on) {
  constexpr std::size_t kWorthAThread = 8;  // pieces: a distance takes a millisecond (chosen)
  const std::size_t most = std::min<std::size_t>(processors(), count / kWorthAThread);
  while (!alone_ && made_.size() + 1 < most) {
    const auto* const shared = dynamic_cast<const SharedBackend*>(&own_);
    const SharedBackend::Another another = shared ? shared->another() : SharedBackend::Another{};
    try {
      if (auto made = another ? another() : nullptr)
        made_.push_back(std::move(made));
      else
        alone_ = true;
    } catch (const std::bad_alloc&) {
      alone_ = true;
    }
  }
  std::vector<CollisionBackend*> others;
  for (const auto& one : made_)
    if (others.size() + 1 < most) others.push_back(one.get());
  return side_by_side(own_, others, count, work, go_on);
}

}  // namespace palpate

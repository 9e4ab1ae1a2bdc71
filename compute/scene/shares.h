#pragma once
#include <algorithm>
#include <atomic>
#include <cstdint>
#include <exception>
#include <mutex>
#include <system_error>
#include <thread>
#include <vector>

#include "model/processors.h"

namespace palpate {

/// Calls work(share) for the shares 0 … count − 1, on this thread and others, one a core (at most 8: chosen),
/// in no order. After each of its own shares this thread asks between(shares begun); false: no more are
/// begun. True: all have been done. Threads that can't be had are done without; what work() throws is thrown
/// again here once all threads have ended.
template <class Work, class Between>
bool in_shares(std::uint32_t count, Work&& work, Between&& between) {
  constexpr unsigned kMostThreads = 8;
  std::atomic<std::uint32_t> next{0};
  std::atomic<bool> end{false};
  std::mutex mutex;
  std::exception_ptr thrown;
  const auto one = [&] {
    if (end) return false;
    const std::uint32_t share = next++;
    if (share >= count) return false;
    try {
      work(share);
    } catch (...) {
      const std::lock_guard lock(mutex);
      thrown = std::current_exception();
      end = true;
    }
    return true;
  };
  std::vector<std::thread> others;
  const unsigned cores = std::min({processors(), kMostThreads, count});
  others.reserve(cores);
  for (unsigned i = 1; i < cores; ++i) {
    try {
      others.emplace_back([&] {
        while (one()) {
        }
      });
    } catch (const std::system_error&) {
      break;
    }
  }
  while (one())
    if (!between(std::min(next.load(), count))) end = true;
  for (std::thread& other : others) other.join();
  if (thrown) std::rethrow_exception(thrown);
  return !end;
}

}  // namespace palpate

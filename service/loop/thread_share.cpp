#include "service/loop/thread_share.h"

#include <dirent.h>
#include <sched.h>
#include <sys/prctl.h>
#include <sys/resource.h>
#include <sys/syscall.h>
#include <unistd.h>

#include <cstdint>
#include <cstdlib>
#include <map>
#include <mutex>
#include <set>

#include "model/processors.h"

namespace palpate {
namespace {

/// What the system call takes (linux/sched/types.h, which does not go with sched.h).
struct SchedulingAttributes {
  std::uint32_t size = sizeof(SchedulingAttributes), policy = SCHED_OTHER;
  std::uint64_t flags = 0;
  std::int32_t nice = 0;
  std::uint32_t priority = 0;
  std::uint64_t runtime_ns = 0, deadline_ns = 0, period_ns = 0;
};

pid_t this_thread() noexcept { return static_cast<pid_t>(::syscall(SYS_gettid)); }

/// Who is moved where. One for the process, since processors are the process's.
class Places {
 public:
  static Places& instance() {
    static Places places;
    return places;
  }

  void for_hand(bool yes) {
    const std::lock_guard lock(mutex_);
    if (!yes) {
      for_hand_.erase(this_thread());
      if (rooms_ > 0) move_off(this_thread());
      return;
    }
    for_hand_.insert(this_thread());
    if (rooms_ > 0) ::sched_setaffinity(0, sizeof all_, &all_);  // who made the thread was moved already
    moved_.erase(this_thread());
  }

  /// All threads but `before` work for a hand.
  void rest_for_hand(const std::set<int>& before) {
    const std::lock_guard lock(mutex_);
    each_thread([&](pid_t thread) {
      if (!before.contains(thread)) for_hand_.insert(thread);
    });
  }
  static std::set<int> threads() {
    std::set<int> out;
    each_thread([&](pid_t thread) { out.insert(thread); });
    return out;
  }

  void room(bool wanted) {
    const std::lock_guard lock(mutex_);
    if (wanted) {
      if (rooms_++ > 0) return;
      (void)processors();  // counted before there are fewer
      // A thread's own mask counts, not the process's: a program may have been given its processors by
      // taskset or a control group.
      processor_ = ::sched_getaffinity(0, sizeof all_, &all_) == 0 ? loop_processor() : -1;
      if (processor_ < 0) return;
      std::erase_if(for_hand_, [now = threads()](pid_t thread) {
        return !now.contains(thread);
      });  // a driver's, gone with its device
      // Once more for threads that were made meanwhile by ones not moved yet; from then on each inherits its
      // maker's place.
      for (int i = 0; i < 2; ++i) each_thread([this](pid_t thread) { move_off(thread); });
      return;
    }
    if (--rooms_ > 0 || processor_ < 0) return;
    cpu_set_t rest = all_;
    CPU_CLR(static_cast<std::size_t>(processor_), &rest);
    each_thread([&](pid_t thread) {
      cpu_set_t may{};
      if (const auto before = moved_.find(thread); before != moved_.end())
        ::sched_setaffinity(thread, sizeof before->second, &before->second);
      else if (::sched_getaffinity(thread, sizeof may, &may) == 0 &&
               CPU_EQUAL(&may, &rest))  // made by one that was moved
        ::sched_setaffinity(thread, sizeof all_, &all_);
    });
    moved_.clear();
  }

 private:
  void move_off(pid_t thread) {
    cpu_set_t may{};
    if (processor_ < 0 || for_hand_.contains(thread) || ::sched_getaffinity(thread, sizeof may, &may) != 0)
      return;
    const auto loops = static_cast<std::size_t>(processor_);
    if (!CPU_ISSET(loops, &may) || CPU_COUNT(&may) < 2) return;  // nowhere else to go
    moved_.try_emplace(thread, may);
    CPU_CLR(loops, &may);
    ::sched_setaffinity(thread, sizeof may, &may);
  }

  template <class Do>
  static void each_thread(Do&& act) {
    DIR* const threads = ::opendir("/proc/self/task");
    if (!threads) return;
    while (const dirent* entry = ::readdir(threads))
      if (const long thread = std::strtol(entry->d_name, nullptr, 10); thread > 0)
        act(static_cast<pid_t>(thread));
    ::closedir(threads);
  }

  std::mutex mutex_;
  int rooms_ = 0, processor_ = -1;
  cpu_set_t all_{};  ///< what the thread that made the first room may run on
  std::set<pid_t> for_hand_;
  std::map<pid_t, cpu_set_t> moved_;  ///< and where it might run before
};

}  // namespace

void set_nice(int level) noexcept { ::setpriority(PRIO_PROCESS, static_cast<id_t>(this_thread()), level); }

void set_slice(int microseconds) noexcept {
  SchedulingAttributes wanted;
  wanted.nice = ::getpriority(PRIO_PROCESS, static_cast<id_t>(this_thread()));  // stays
  wanted.runtime_ns = static_cast<std::uint64_t>(microseconds) * 1000;
  ::syscall(SYS_sched_setattr, 0, &wanted, 0);
}

void set_exact_sleep() noexcept { ::prctl(PR_SET_TIMERSLACK, 1UL); }

int loop_processor() noexcept {
  cpu_set_t may{};
  if (::sched_getaffinity(0, sizeof may, &may) != 0 || CPU_COUNT(&may) < 2) return -1;
  int last = CPU_SETSIZE - 1;
  while (!CPU_ISSET(static_cast<std::size_t>(last), &may)) --last;
  return last;
}

ForHand::ForHand() noexcept {
  try {
    Places::instance().for_hand(true);
  } catch (...) {  // no memory: it runs where it is
  }
}
ForHand::~ForHand() { Places::instance().for_hand(false); }
MakesForHand::MakesForHand() : before_(Places::threads()) {}
MakesForHand::~MakesForHand() {
  try {
    Places::instance().rest_for_hand(before_);
  } catch (...) {  // no memory: they are moved as all others are
  }
}
LoopRoom::LoopRoom() { Places::instance().room(true); }
LoopRoom::~LoopRoom() { Places::instance().room(false); }

}  // namespace palpate

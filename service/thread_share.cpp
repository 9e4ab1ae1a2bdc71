#include "service/thread_share.h"

#include <sched.h>
#include <sys/resource.h>
#include <sys/syscall.h>
#include <unistd.h>

#include <cstdint>

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

}  // namespace

void set_nice(int level) noexcept { ::setpriority(PRIO_PROCESS, static_cast<id_t>(::syscall(SYS_gettid)), level); }

void set_slice(int microseconds) noexcept {
  SchedulingAttributes wanted;
  wanted.nice = ::getpriority(PRIO_PROCESS, static_cast<id_t>(::syscall(SYS_gettid)));   // stays
  wanted.runtime_ns = static_cast<std::uint64_t>(microseconds) * 1000;
  ::syscall(SYS_sched_setattr, 0, &wanted, 0);
}

}  // namespace palpate

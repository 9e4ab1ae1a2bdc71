#include "model/processors.h"

#include <gtest/gtest.h>
#include <sched.h>
#include <sys/wait.h>
#include <unistd.h>

#include <cstddef>

namespace palpate {
namespace {

/// The count that a process sees which may use the first `wanted` of its processors, or −1.
int seen_by_a_process_on(int wanted) {
  const pid_t child = ::fork();
  if (child == 0) {
    cpu_set_t may, some;
    CPU_ZERO(&some);
    if (::sched_getaffinity(0, sizeof may, &may) != 0) ::_exit(255);
    for (std::size_t i = 0; i < CPU_SETSIZE && CPU_COUNT(&some) < wanted; ++i)
      if (CPU_ISSET(i, &may)) CPU_SET(i, &some);
    if (::sched_setaffinity(0, sizeof some, &some) != 0) ::_exit(255);
    const unsigned before = processors();
    // What the mask becomes later doesn't matter.
    ::sched_setaffinity(0, sizeof may, &may);
    ::_exit(before == processors() ? static_cast<int>(before) : 254);
  }
  int status = 0;
  if (child < 0 || ::waitpid(child, &status, 0) != child || !WIFEXITED(status)) return -1;
  return WEXITSTATUS(status);
}

TEST(Processors, AreThoseOfTheMaskWhenTheyWereFirstCounted) {
  cpu_set_t may;
  ASSERT_EQ(::sched_getaffinity(0, sizeof may, &may), 0);
  EXPECT_EQ(seen_by_a_process_on(1), 1);
  EXPECT_EQ(seen_by_a_process_on(CPU_COUNT(&may)), CPU_COUNT(&may));
}

}  // namespace
}  // namespace palpate

#include "model/processors.h"

#include <sched.h>

#include <algorithm>
#include <thread>

namespace palpate {

unsigned processors() noexcept {
  static const unsigned count = [] {
    cpu_set_t may;
    const int counted = ::sched_getaffinity(0, sizeof may, &may) == 0 ? CPU_COUNT(&may) : 0;
    // More processors than the mask has room for: the machine's count.
    return counted > 0 ? static_cast<unsigned>(counted) : std::max(1u, std::thread::hardware_concurrency());
  }();
  return count;
}

}  // namespace palpate

#include "model/large_pages.h"

#include <sys/mman.h>

namespace palpate {

void want_large_pages(void* data, std::size_t bytes) {
  const auto begin = (reinterpret_cast<std::uintptr_t>(data) + kLargePage - 1) / kLargePage * kLargePage;
  const auto end = (reinterpret_cast<std::uintptr_t>(data) + bytes) / kLargePage * kLargePage;
  if (end >= begin + 2 * kLargePage) ::madvise(reinterpret_cast<void*>(begin), end - begin, MADV_HUGEPAGE);   // a wish: refused, all goes on as without it
}

}  // namespace palpate

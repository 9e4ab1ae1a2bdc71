// The list that entry `entry` of a CSR of `lists` lists belongs to, by bisection of LIST_BEGIN (empty lists are skipped).
uint32_t list_of_entry(uint32_t entry, uint32_t lists) {
  uint32_t lo = 0u, hi = lists;
  while (hi - lo > 1u) {
    uint32_t middle = (lo + hi) >> 1;
    if (LIST_BEGIN[middle] <= entry) lo = middle;
    else hi = middle;
  }
  return lo;
}

// Union-find without locks. Node 2·slot joins areas, node 2·slot + 1 joins zones. The including shader declares
//   coherent buffer uint32_t parents[], uint32_t contact_statics[], FrameState frame_state.
// A root is only ever hooked to a root of a smaller static id, so parents never form a ring and a set's root is its smallest id.

uint32_t union_budget = 0u;   // loop iterations of this invocation

// Notes that the work was cut short; the frame is truncated.
bool union_spent() {
  if (++union_budget < kLoopBudget) return false;
  atomicOr(frame_state.overflow_other, kOverflowLoop);
  return true;
}

uint32_t union_root(uint32_t node) {
  while (!union_spent()) {
    const uint32_t parent = parents[node];
    if (parent == node) return node;
    const uint32_t above = parents[parent];
    if (above == parent) return parent;
    parents[node] = above;   // halves the path; only nodes that are no roots are written, and only with an ancestor
    node = above;
  }
  return node;
}

void union_join(uint32_t a, uint32_t b) {
  while (!union_spent()) {
    a = union_root(a);
    b = union_root(b);
    if (a == b) return;
    const bool a_first = contact_statics[a >> 1] < contact_statics[b >> 1];
    const uint32_t small = a_first ? a : b, large = a_first ? b : a;
    if (atomicCompSwap(parents[large], large, small) == large) return;
  }
}

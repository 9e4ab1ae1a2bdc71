// Union-find without locks. Nodes of a slot: one joins areas and, where there are ZONES, one joins zones. The
// including shader declares
//   coherent buffer uint32_t parents[], uint32_t contact_statics[], FrameState frame_state.
// A root is only ever hooked to a root of a smaller static id, so parents never form a ring and a set's root
// is its smallest id.

#include "shaders/lib/budget.glsl"
#include "shaders/lib/union_nodes.glsl"

uint32_t union_root(uint32_t node) {
  while (!spent(1u)) {
    const uint32_t parent = parents[node];
    if (parent == node) return node;
    const uint32_t above = parents[parent];
    if (above == parent) return parent;
    // Halves the path; only nodes that are no roots are written, and only with an ancestor.
    parents[node] = above;
    node = above;
  }
  return node;
}

void union_join(uint32_t a, uint32_t b) {
  while (!spent(1u)) {
    a = union_root(a);
    b = union_root(b);
    if (a == b) return;
    const bool a_first = contact_statics[slot_of_node(a)] < contact_statics[slot_of_node(b)];
    const uint32_t small = a_first ? a : b, large = a_first ? b : a;
    if (atomicCompSwap(parents[large], large, small) == large) return;
  }
}

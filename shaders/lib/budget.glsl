// llvmpipe ends an invocation's loops silently at 65,535 iterations, all of them together. Every loop of
// unknown length asks spent() and gives up instead, and whoever has such loops tells it: tell_spent() before
// the invocation goes on with another pose, and at the end of main(). (Not at once: for an atomic operation
// llvmpipe goes through its lanes one by one, even where none wants it.) The including shader declares
// `FrameState frame_state`, writable.
#ifndef PALPATE_LIB_BUDGET
#define PALPATE_LIB_BUDGET

uint32_t loop_budget = 0u;   // iterations of this invocation so far

bool spent(uint32_t iterations) {
  loop_budget += iterations;
  return loop_budget >= kLoopBudget;
}

void tell_spent() {
  if (loop_budget >= kLoopBudget) atomicOr(frame_state.overflow_other, kOverflowLoop);
}
#endif

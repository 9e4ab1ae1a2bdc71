// llvmpipe ends an invocation's loops silently at 65,535 iterations, all of them together. Every loop of
// unknown length asks spent() and gives up with an overflow instead. The including shader declares
// `FrameState frame_state`, writable.
#ifndef PALPATE_LIB_BUDGET
#define PALPATE_LIB_BUDGET

uint32_t loop_budget = 0u;   // iterations of this invocation so far

bool spent(uint32_t iterations) {
  loop_budget += iterations;
  if (loop_budget < kLoopBudget) return false;
  atomicOr(frame_state.overflow_other, kOverflowLoop);
  return true;
}
#endif

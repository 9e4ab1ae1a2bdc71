#version 460
#extension GL_GOOGLE_include_directive : require
// Gives each bin its stretch of the entries, in any order. An invocation a bin.
#include "shaders/lib/frame.glsl"

EDIT(kBindToolBins, ToolBin, tool_bins);
EDIT_ONE(kBindBinState, BinState, bin_state);

void main() {
  const uint32_t i = flat_invocation();
  if (i >= uint32_t(tool_bins.length()) || tool_bins[i].count == 0u) return;
  tool_bins[i].begin = atomicAdd(bin_state.entries, tool_bins[i].count);
}

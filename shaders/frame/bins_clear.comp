#version 460
#extension GL_GOOGLE_include_directive : require
// Empties the bins. An invocation a bin.
#include "shaders/lib/frame.glsl"

EDIT(kBindToolBins, ToolBin, tool_bins);

void main() {
  const uint32_t i = flat_invocation();
  if (i < uint32_t(tool_bins.length())) tool_bins[i] = ToolBin(0u, 0u, 0u);
}

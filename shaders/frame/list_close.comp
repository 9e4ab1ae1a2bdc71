#version 460
#extension GL_GOOGLE_include_directive : require
// Closes the lists whose bits are in `lists`: clamps, notes overflows, works out group counts.
// One workgroup; invocation i handles list i. Edits frame_lists, frame_state.
#include "shaders/lib/frame.glsl"

EDIT(kBindFrameLists, FrameList, frame_lists);
EDIT_ONE(kBindFrameState, FrameState, frame_state);

layout(push_constant, scalar) uniform Push { uint32_t lists; };

void main() {
  const uint32_t i = gl_LocalInvocationIndex;
  if (i >= kListCount || (lists >> i & 1u) == 0u) return;
  const uint32_t asked = frame_lists[i].count;
  const uint32_t count = min(asked, frame_lists[i].capacity);
  if (count != asked) atomicOr(frame_state.overflow, 1u << i);
  frame_lists[i].asked = asked;
  frame_lists[i].count = count;
  frame_lists[i].items = groups_for((count + kGroupSize - 1u) / kGroupSize);
  frame_lists[i].groups = groups_for(count);
}

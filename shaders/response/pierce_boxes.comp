#version 460
// One invocation: kSlotBox slots of C_s. Works out the box of their triangles.
// Reads C_s, the mock-up's triangles. Writes slot_boxes.
// Before: the list of C_s is closed.
#extension GL_GOOGLE_include_directive : require
#include "shaders/lib/frame.glsl"
#include "shaders/shared/frame_response.h"

READ(kBindFrameLists, FrameList, frame_lists);
READ(kBindContactStatics, uint32_t, contact_statics);
READ(kBindMockupVertices, ivec3, mockup_vertices);
READ(kBindMockupTriangles, uvec3, mockup_triangles);
EDIT(kBindSlotBoxes, LatticeBox, slot_boxes);

void main() {
  const uint32_t count = frame_lists[kListContactStatics].count;
  const uint32_t begin = flat_invocation() * kSlotBox, end = min(begin + kSlotBox, count);
  if (begin >= count) return;
  ivec3 low = ivec3(0x7FFFFFFF), high = ivec3(-0x7FFFFFFF);
  for (uint32_t slot = begin; slot < end; ++slot) {
    const uvec3 corners = mockup_triangles[contact_statics[slot]];
    const ivec3 a = mockup_vertices[corners.x], b = mockup_vertices[corners.y], c = mockup_vertices[corners.z];
    low = min(low, min(min(a, b), c));
    high = max(high, max(max(a, b), c));
  }
  slot_boxes[flat_invocation()] = LatticeBox(low, high);
}

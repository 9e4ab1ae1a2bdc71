// One invocation: one number. Writes it plus one.
#version 460
#extension GL_GOOGLE_include_directive : require
#include "shaders/lib/item.glsl"

layout(scalar, set = 0, binding = 0) readonly buffer From { uint32_t from[]; };
layout(scalar, set = 0, binding = 1) writeonly buffer To { uint32_t to[]; };
layout(push_constant) uniform Push { uint32_t count; };

void main() {
  uint32_t i = item_index();
  if (i < count) to[i] = from[i] + 1u;
}

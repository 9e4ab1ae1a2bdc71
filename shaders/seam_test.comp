// One invocation: a pair of triangles that seam_find found. Writes 1 if they touch along a seam, exactly, else 0.
#version 460
#extension GL_GOOGLE_include_directive : require
#include "shaders/lib/item.glsl"
#include "shaders/lib/seam.glsl"

layout(scalar, set = 0, binding = 0) readonly buffer Vertices { ivec3 vertices[]; };
layout(scalar, set = 0, binding = 1) readonly buffer Triangles { uvec3 triangles[]; };
layout(scalar, set = 0, binding = 2) readonly buffer Pairs { uvec2 pairs[]; };
layout(scalar, set = 0, binding = 3) writeonly buffer Touches { uint32_t touches[]; };
layout(push_constant, scalar) uniform Push { uint32_t count; };

Triangle load(uvec3 corner) { return Triangle(vertices[corner.x], vertices[corner.y], vertices[corner.z]); }

void main() {
  uint32_t i = item_index();
  if (i >= count) return;
  uvec3 of_s = triangles[pairs[i].x], of_t = triangles[pairs[i].y];
  touches[i] = touch_along_a_seam(load(of_s), load(of_t), of_s, of_t) ? 1u : 0u;
}

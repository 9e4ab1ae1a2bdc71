// One invocation: one point of one grid. Reads cases, writes the cells that hold it, touch it, and have its number.
#version 460
#extension GL_GOOGLE_include_directive : require
#include "shaders/lib/item.glsl"
#include "shaders/lib/frame.glsl"
#include "shaders/lib/cells.glsl"
#include "shaders/lib/voxel_range.glsl"
#include "tests/compute/shaders/probe_geometry.h"

layout(scalar, set = 0, binding = 0) readonly buffer Cases { CellCase cases[]; };
layout(scalar, set = 0, binding = 1) writeonly buffer Answers { CellAnswer answers[]; };
layout(push_constant) uniform Push { uint32_t count; };

void main() {
  uint32_t i = item_index();
  if (i >= count) return;
  CellCase c = cases[i];
  ivec3 along = cell_along(c.d, c.side, c.n), held = clamp(along, ivec3(0), c.n - 1);
  answers[i] = CellAnswer(along, first_touched(c.d, ivec3(0), c.side), last_touched(c.d, ivec3(0), c.side), cell_of_number(cell_number(held, c.n), c.n));
}

// One invocation: a triangle and the whole grid, or an item (triangle, cell) of the level above. Finds the
// cells of this level that, closed and grown, touch the triangle. emit 0: writes their number to counts; emit
// 1: reads counts, now prefix sums, and writes the items. Before: cells of this level are at most kTopCells
// along each axis (large triangles), or an eighth of the parents' (items), so that no invocation tests more
// than 512.
#version 460
#extension GL_GOOGLE_include_directive : require
#include "shaders/lib/cells.glsl"
#include "shaders/lib/item.glsl"
#include "shaders/lib/triangle_voxel.glsl"
#include "shaders/shared/prepare.h"
#include "shaders/shared/scene.h"

layout(scalar, set = 0, binding = 0) readonly buffer Vertices { ivec3 vertices[]; };
layout(scalar, set = 0, binding = 1) readonly buffer Triangles { uvec3 triangles[]; };
layout(scalar, set = 0, binding = 2) readonly buffer Info { uint32_t triangle_info[]; };
layout(scalar, set = 0, binding = 3) readonly buffer ItemTriangle { uint32_t item_triangle[]; };
layout(scalar, set = 0, binding = 4) readonly buffer ItemCell { uint32_t item_cell[]; };
layout(scalar, set = 0, binding = 5) buffer Counts { uint32_t counts[]; };
layout(scalar, set = 0, binding = 6) writeonly buffer OutTriangle { uint32_t out_triangle[]; };
layout(scalar, set = 0, binding = 7) writeonly buffer OutCell { uint32_t out_cell[]; };
layout(push_constant, scalar) uniform Push { ExpandPush push; };

void main() {
  uint32_t item = item_index();
  if (item >= push.count) return;
  uint32_t t = push.source == kSourceItems ? item_triangle[item] : item;
  uvec3 corner = triangles[t];
  ivec3 a = vertices[corner.x], b = vertices[corner.y], c = vertices[corner.z];
  ivec3 lo = min(a, min(b, c)), hi = max(a, max(b, c));
  ivec3 first = first_cell(lo, push.origin, push.side, push.growth);
  ivec3 last = last_cell(hi, push.origin, push.side, push.growth, push.cells);
  bool mine = true;
  if (push.source == kSourceItems) {
    ivec3 parent = cell_of_number(item_cell[item], push.parents);
    first = max(first, parent * 8);
    last = min(last, parent * 8 + 7);
  } else {
    ivec3 span = last_cell(hi, push.origin, push.brick_side, push.growth, push.bricks) -
                 first_cell(lo, push.origin, push.brick_side, push.growth) + 1;
    // Spans are at most kMostBricksAlong < 2^12, so the product fits.
    bool is_small = uint64_t(span.x) * uint64_t(span.y) * uint64_t(span.z) <= uint64_t(kSmallCells);
    mine = (triangle_info[t] & kInfoCollapsed) == 0u && is_small == (push.source == kSourceSmall);
  }
  uint32_t found = 0u;
  if (mine) {
    i64vec3 n = raw_normal(a, b, c);
    ivec3 grid_end = push.origin + push.bricks * push.brick_side;
    uint32_t at = push.emit != 0u ? counts[item] : 0u;
    // One loop instead of three: invocations that run together are done after the most cells that any of them
    // has.
    ivec3 cell = first;
    while (all(lessThanEqual(cell, last))) {
      ivec3 box_lo = push.origin + cell * push.side;
      ivec3 box_hi = min(box_lo + push.side, grid_end);
      if (triangle_touches_box(a, b, c, n, box_lo - push.growth, box_hi + push.growth)) {
        if (push.emit != 0u) {
          out_triangle[at + found] = t;
          out_cell[at + found] = cell_number(cell, push.cells);
        }
        ++found;
      }
      cell = next_cell(cell, first, last);
    }
  }
  if (push.emit == 0u) counts[item] = found;
}

#version 460
// One invocation: an entry of the mock-up's lists, from `first` on, a triangle in a voxel. Counts the
// triangle's samples that lie in the voxel (EMIT 0), or lists them, and whether its first corner lies in it
// (EMIT 1; form: compute/scene/samples.h).
// Reads the mock-up and its partition. Writes begins[]; EMIT 1 also samples[], from those of number `base`
// on.
#extension GL_GOOGLE_include_directive : require
#include "shaders/lib/item.glsl"
#include "shaders/shared/scene.h"
#include "shaders/shared/prepare.h"
#include "shaders/shared/frame.h"

layout(constant_id = 0) const uint32_t EMIT = 0u;

layout(scalar, set = 0, binding = 0) readonly buffer Vertices { ivec3 vertices[]; };
layout(scalar, set = 0, binding = 1) readonly buffer Triangles { uvec3 triangles[]; };
layout(scalar, set = 0, binding = 2) readonly buffer Info { uint32_t info[]; };
layout(scalar, set = 0, binding = 3) readonly buffer EntryVoxel { uint32_t entry_voxel[]; };
layout(scalar, set = 0, binding = 4) readonly buffer List { uint32_t list_triangles[]; };
layout(scalar, set = 0, binding = 5) readonly buffer Place { uint32_t boundary_place[]; };
layout(scalar, set = 0, binding = 6) readonly buffer Mixed { uint32_t mixed_brick[]; };
layout(scalar, set = 0, binding = 7) buffer Begin { uint32_t begins[]; };
layout(scalar, set = 0, binding = 8) writeonly buffer Samples { uint32_t samples[]; };
layout(push_constant, scalar) uniform Push { SampleListPush push; };

#include "shaders/lib/cells.glsl"
#include "shaders/lib/sample.glsl"

void main() {
  if (item_index() >= push.count) return;
  const uint32_t entry = item_index() + push.first;
  const uint32_t place = boundary_place[entry_voxel[entry]], bit = place & 511u;
  const ivec3 voxel =
      8 * cell_of_number(mixed_brick[place >> 9], push.bricks) + ivec3(bit & 7u, bit >> 3 & 7u, bit >> 6);
  // The last lattice point of the half-open cube.
  const ivec3 low = push.origin + push.size * voxel, high = low + push.size - 1;
  const uint32_t id = list_triangles[entry];
  const uvec3 corners = triangles[id];
  SampledTriangle t;
  t.a = vertices[corners.x];
  t.b = vertices[corners.y];
  t.c = vertices[corners.z];
  t.axis = int(info[id] >> kInfoAxisShift & 3u);
  t.normal = raw_normal(t.a, t.b, t.c);
  uint32_t count = 0u;
  const uint32_t begin = EMIT != 0u ? begins[entry] : 0u;
  const ivec2 grid = cell_of_sample(seen_along(t.axis, low), push.spacing);
  // Cells that reach into the voxel and into the triangle's box; at most 64 an axis, as a voxel is at most 63
  // spacings.
  const ivec2 first = cell_of_sample(seen_along(t.axis, max(low, min(min(t.a, t.b), t.c))), push.spacing);
  const ivec2 last = cell_of_sample(seen_along(t.axis, min(high, max(max(t.a, t.b), t.c))), push.spacing);
  for (int32_t j = first.y; j <= last.y; ++j) {
    for (int32_t i = first.x; i <= last.x; ++i) {
      const ivec2 g = sample_of_cell(ivec2(i, j), push.spacing);
      if (!grid_point_inside(t, g)) continue;
      const ivec3 point = sample_point(t, g);
      if (any(lessThan(point, low)) || any(greaterThan(point, high))) continue;
      if (EMIT != 0u) {
        const uint32_t place = uint32_t(i - grid.x) | uint32_t(j - grid.y) << 6;
        const uint32_t height = uint32_t(point[t.axis] - low[t.axis]), at = begin - push.base + count;
        if (push.wide != 0u) {
          samples[2u * at] = height;
          samples[2u * at + 1u] = place;
        } else {
          samples[at] = height | place << 20;
        }
      }
      count += 1u;
    }
  }
  const bool corner = all(greaterThanEqual(t.a, low)) && all(lessThanEqual(t.a, high));
  begins[entry] =
      EMIT == 0u ? count : begin | (corner ? kSampleCorner : 0u) | uint32_t(t.axis) << kSampleAxisShift;
}

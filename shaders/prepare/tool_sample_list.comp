#version 460
// One invocation: cells of the sample grid in a tool triangle's box. Counts the triangle's samples in them
// (EMIT 0), or lists them with their levels (EMIT 1).
// Reads the tool and tiles[]. Writes begins[] (EMIT 0) or samples[].
#extension GL_GOOGLE_include_directive : require
#include "shaders/lib/item.glsl"
#include "shaders/shared/scene.h"
#include "shaders/shared/prepare.h"
#include "shaders/shared/frame_field.h"

layout(constant_id = 0) const uint32_t EMIT = 0u;

layout(scalar, set = 0, binding = 0) readonly buffer Vertices { ivec3 vertices[]; };
layout(scalar, set = 0, binding = 1) readonly buffer Triangles { uvec3 triangles[]; };
layout(scalar, set = 0, binding = 2) readonly buffer Info { uint32_t info[]; };
layout(scalar, set = 0, binding = 3) readonly buffer Tiles { ToolSampleTile tiles[]; };
layout(scalar, set = 0, binding = 4) buffer Begin { uint32_t begins[]; };
layout(scalar, set = 0, binding = 5) writeonly buffer Samples { uvec4 samples[]; };
layout(push_constant, scalar) uniform Push { ToolSamplePush push; };

#include "shaders/lib/sample.glsl"

void main() {
  if (item_index() >= push.count) return;
  const ToolSampleTile tile = tiles[item_index()];
  const uvec3 corners = triangles[tile.triangle];
  SampledTriangle t;
  t.a = vertices[corners.x];
  t.b = vertices[corners.y];
  t.c = vertices[corners.z];
  t.axis = int(info[tile.triangle] >> kInfoAxisShift & 3u);
  t.normal = raw_normal(t.a, t.b, t.c);
  uint32_t count = 0u;
  const uint32_t begin = EMIT != 0u ? begins[item_index()] : 0u;
  for (uint32_t cell = tile.begin; cell < tile.end; ++cell) {
    const ivec2 ij = ivec2(tile.first_u, tile.first_v) + ivec2(cell % tile.across, cell / tile.across),
                g = sample_of_cell(ij, push.spacing);
    if (!grid_point_inside(t, g)) continue;
    if (EMIT != 0u) samples[begin + count] = uvec4(sample_point(t, g), level_of_cell(ij));
    count += 1u;
  }
  if (EMIT == 0u) begins[item_index()] = count;
}

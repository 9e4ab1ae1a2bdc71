#version 460
// One workgroup for all areas: n_c by the rules of docs/EXACTNESS.md section 6, or a request for the nearest V_ext voxel.
// Reads areas, held areas. Writes areas[].direction and flags, requests, dispatches of what follows.
// Before: areas_first, mobile_normals.
#extension GL_GOOGLE_include_directive : require
#include "shaders/lib/frame.glsl"
#include "shaders/shared/frame_response.h"

layout(constant_id = 0) const bool REFINED = true;

CONSTANT(kBindScene, SceneConstants, scene);
READ(kBindHeldAreas, HeldDirection, held_areas);
EDIT(kBindDispatches, DispatchArguments, dispatches);
EDIT_ONE(kBindResponseState, ResponseState, response);
EDIT(kBindAreas, AreaWork, areas);

#include "shaders/lib/area.glsl"

void direct_refined(uint32_t area) {
  if ((areas[area].state & kAreaProximity) != 0u) return;
  uint32_t flags = areas[area].flags;
  if (scene.tool.closed == 0u && scene.tool.has_internal == 0u) flags |= kAreaFlagToolOpen;

  // One zone: static, bare static, mobile; more: mobile, static, bare static. A sum of samples that has cancelled is told.
  const bool several = areas[area].zones > 1u;
  i64vec3 chosen = i64vec3(0l);
  for (uint32_t rule = 0u; rule < 3u && chosen == i64vec3(0l); ++rule) {
    const uint32_t sum_of = (rule + (several ? 2u : 0u)) % 3u;   // 0 static, 1 bare static, 2 mobile
    const i64vec3 sum = sum_of == 0u ? static_sum(area) : sum_of == 1u ? bare_sum(area) : -vector_of(areas[area].mobile_sum);
    const int64_t weight = sum_of == 0u ? areas[area].static_weight
                                        : sum_of == 1u ? int64_t(areas[area].cst) << 30 : areas[area].mobile_weight;
    if (usable(sum, weight)) chosen = sum;
    else if (sum_of != 1u && weight > 0l) flags |= kAreaFlagCancelled;
  }
  if (chosen == i64vec3(0l)) {
    const uint32_t held = areas[area].held_area;
    if (held != kNone) {   // an area without a direction is not held
      chosen = i64vec3(held_areas[held].direction);
      flags |= kAreaFlagHeld;
    } else {
      const ivec3 centre = (areas[area].box_low + areas[area].box_high) >> 1;
      response.request[atomicAdd(response.requests, 1u)] = NearestRequest(~0ul, ~0ul, centre, area);
    }
  }
  if (chosen != i64vec3(0l)) areas[area].direction = normalise(chosen);
  areas[area].flags = flags;
}

void direct_paper(uint32_t area) {
  const i64vec3 sum = areas[area].zones > 1u ? -vector_of(areas[area].mobile_sum) : vector_of(areas[area].fixed_sum);
  if (sum == i64vec3(0l)) areas[area].flags = kAreaFlagCancelled | kAreaFlagNoDirection;
  else areas[area].direction = normalise(sum);
}

void main() {
  const uint32_t count = min(response.areas, kMaxFrameAreas);
  for (uint32_t area = gl_LocalInvocationIndex; area < count; area += kGroupSize) {
    if (REFINED) direct_refined(area);
    else direct_paper(area);
  }
  memoryBarrierBuffer();
  barrier();
  if (gl_LocalInvocationIndex != 0u) return;
  const uint32_t requests = atomicAdd(response.requests, 0u);
  if (requests > 0u) {
    const ivec3 bricks = scene.mockup.grid.bricks;
    const uint32_t total = uint32_t(bricks.x) * uint32_t(bricks.y) * uint32_t(bricks.z);
    DispatchArguments groups = groups_for((total + kGroupSize - 1u) / kGroupSize);
    groups.z = requests;
    dispatches[kDispatchNearest] = groups;
    dispatches[kDispatchNearestOne] = DispatchArguments(1u, 1u, 1u);
  }
}

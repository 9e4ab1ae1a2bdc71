// One invocation: one point at one pose. Reads cases, writes where the point is in the world and in the tool.
#version 460
#extension GL_GOOGLE_include_directive : require
#include "shaders/lib/item.glsl"
#include "shaders/lib/plan.glsl"
#include "tests/compute/shaders/probe_frame.h"

layout(scalar, set = 0, binding = 0) readonly buffer Cases { PoseCase cases[]; };
layout(scalar, set = 0, binding = 1) writeonly buffer Answers { PoseAnswer answers[]; };
layout(push_constant) uniform Push { uint32_t count; };

uint32_t probed;
#define frame_input cases[probed]
#include "shaders/lib/pose.glsl"

void main() {
  probed = item_index();
  if (probed >= count) return;
  const ivec3 p = cases[probed].point;
  answers[probed] = PoseAnswer(world_from_tool(p), tool_from_world(p));
}

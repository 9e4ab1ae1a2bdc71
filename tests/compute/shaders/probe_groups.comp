// One invocation: one number of workgroups. Reads numbers, writes the dispatch of so many.
#version 460
#extension GL_GOOGLE_include_directive : require
#include "shaders/lib/item.glsl"
#include "shaders/lib/frame.glsl"
#include "tests/compute/shaders/probe_frame.h"

layout(scalar, set = 0, binding = 0) readonly buffer Cases { uint32_t cases[]; };
layout(scalar, set = 0, binding = 1) writeonly buffer Answers { GroupsAnswer answers[]; };
layout(push_constant) uniform Push { uint32_t count; };

void main() {
  const uint32_t i = item_index();
  if (i >= count) return;
  const DispatchArguments groups = groups_for(cases[i]);
  answers[i] = GroupsAnswer(groups.x, groups.y, groups.z);
}

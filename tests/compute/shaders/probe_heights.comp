// One invocation: one sample with its height. Reads cases, writes what it adds to an area.
#version 460
#extension GL_GOOGLE_include_directive : require
#include "shaders/lib/item.glsl"
#include "tests/compute/shaders/probe_sums.h"
#include "shaders/shared/frame_response.h"

shared AreaWork areas[1];   // where a frame's sums go; not asked
#include "shaders/lib/height_sum.glsl"

layout(scalar, set = 0, binding = 0) readonly buffer Cases { HeightCase cases[]; };
layout(scalar, set = 0, binding = 1) writeonly buffer Answers { HeightAnswer answers[]; };
layout(push_constant) uniform Push { uint32_t count; };

void main() {
  uint32_t i = item_index();
  if (i >= count) return;
  HeightCase c = cases[i];
  HeightSum sum = height_sum_empty();
  height_sum_add(sum, c.point, c.height, c.weight, c.fade);
  HeightAnswer a;
  a.rays = sum.rays;
  a.max_height = sum.max_height;
  a.height = sum.height;
  a.weight = sum.weight;
  a.faded = sum.faded;
  a.rest = sum.rest;
  a.weight_slope = sum.weight_slope;
  a.height_slope = sum.height_slope;
  for (int k = 0; k < 3; ++k) {
    a.moment_low[k] = sum.moment_low[k];
    a.moment_high[k] = sum.moment_high[k];
  }
  answers[i] = a;
}

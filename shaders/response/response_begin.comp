#version 460
// One invocation of one workgroup: an empty response.
// Reads nothing. Writes response.
// Before: sets and their dispatches are known. Runs only with contact.
#extension GL_GOOGLE_include_directive : require
#include "shaders/lib/frame.glsl"
#include "shaders/shared/frame_response.h"

EDIT_ONE(kBindResponseState, ResponseState, response);

void main() {
  if (gl_LocalInvocationIndex == 0u) response.areas = 0u;
}

#version 460
// One invocation of one workgroup: an empty response; for a swallowed tool the direction, or the request for one.
// Reads input, state. Writes response.
// Before: sets and their dispatches are known. Runs only with contact.
#extension GL_GOOGLE_include_directive : require
#include "shaders/lib/frame.glsl"
#include "shaders/shared/frame_response.h"

CONSTANT(kBindFrameInput, FrameInput, frame_input);
READ_ONE(kBindFrameState, FrameState, frame_state);
EDIT_ONE(kBindResponseState, ResponseState, response);

void main() {
  if (gl_LocalInvocationIndex != 0u) return;
  response.areas = 0u;
  response.requests = 0u;
  response.swallowed_flags = 0u;
  response.swallowed_direction = ivec3(0);
  response.swallowed_steps = 0u;
  if (frame_state.swallowed == 0u) return;
  response.swallowed_flags = kAreaFlagSwallowed;
  if (frame_input.last_direction != ivec3(0)) {
    response.swallowed_direction = frame_input.last_direction;
    response.swallowed_flags |= kAreaFlagHeld;
  } else {
    response.request[0] = NearestRequest(~0ul, ~0ul, frame_input.translation, kNone);
    response.requests = 1u;   // a swallowed tool has no areas: nobody else asks
  }
}

#version 460
// One invocation: a word of the field. Empties it.
// Reads nothing. Writes field_work.
// Before: nothing. Runs only with contact.
#extension GL_GOOGLE_include_directive : require
#include "shaders/lib/frame.glsl"
#include "shaders/shared/frame_field.h"

EDIT(kBindFieldWork, int64_t, field_work);

void main() {
  if (flat_invocation() < kFieldWords) field_work[flat_invocation()] = 0l;
}

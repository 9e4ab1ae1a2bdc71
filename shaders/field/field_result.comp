#version 460
// One invocation: a word of the field. Hands it to the host.
// Reads field_work. Writes result_field.
// Before: all pushes are added.
#extension GL_GOOGLE_include_directive : require
#include "shaders/lib/frame.glsl"
#include "shaders/shared/frame_field.h"

READ(kBindFieldWork, int64_t, field_work);
EDIT(kBindResultField, int64_t, result_field);

void main() {
  if (flat_invocation() < kFieldWords) result_field[flat_invocation()] = field_work[flat_invocation()];
}

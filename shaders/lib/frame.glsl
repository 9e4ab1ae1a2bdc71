// What every shader of a frame begins with: extensions, workgroup, how buffers are named, flat indices.
#ifndef PALPATE_FRAME_GLSL
#define PALPATE_FRAME_GLSL
#include "shaders/shared/base.h"
#include "shaders/shared/scene.h"
#include "shaders/shared/frame.h"

layout(local_size_x = kGroupSize) in;

layout(constant_id = 20) const bool BATCH = false;   // kBatchConstant: many poses (shared/frame_batch.h)
uint32_t frame_pose = 0u;   // of the invocation's item; lib/batch/batch.glsl
// How finely work is cut (ids in shared/frame.h, choices in compute/gpu/frame/plan.cpp): invocations that look
// for a sample's depth together; NearRuns of a workgroup, kGroupSize / kRunSize at most; entries of a
// PairChunk; points of a SampleChunk, where they are listed; cells of a tile of tool samples.
layout(constant_id = 21) const uint32_t LANES = 8u;
layout(constant_id = 22) const uint32_t RUNS_A_GROUP = 8u;
layout(constant_id = 23) const uint32_t PAIR_CHUNK = 16u;
layout(constant_id = 24) const uint32_t LISTED_CHUNK = 16u;
layout(constant_id = 25) const uint32_t FIELD_TILE = 64u;

// An array of T behind `bind`, called `name`; and a single T.
#define READ(bind, T, name) layout(set = 0, binding = bind, scalar) readonly buffer name##_block { T name[]; }
#define EDIT(bind, T, name) layout(set = 0, binding = bind, scalar) buffer name##_block { T name[]; }
#define READ_ONE(bind, T, name) \
  layout(set = 0, binding = bind, scalar) readonly buffer name##_block { T name; }
// A small T that no shader of the frame writes: a uniform buffer, which llvmpipe reads once for all lanes:
// kBindScene and kBindFrameInput (make_frame_shader() of compute/gpu/frame/recorder.cpp).
#define CONSTANT(bind, T, name) layout(set = 0, binding = bind, scalar) uniform name##_block { T name; }
#define EDIT_ONE(bind, T, name) layout(set = 0, binding = bind, scalar) buffer name##_block { T name; }

// What is looked up by number, as a function name(i): a word T, a vector T of three, a texel of four words. llvmpipe
// loads a word of READ lane by lane, behind a test of its own; a texel it takes in one piece, a fifth of the time.
// So where it runs them shaders are compiled with PALPATE_TEXELS (scripts/cmake/PalpateShaders.cmake).
#ifdef PALPATE_TEXELS
#define TEXELS(bind, name)                                            \
  layout(set = 0, binding = bind) uniform usamplerBuffer name##_texels; \
  uvec4 name(uint32_t i) { return texelFetch(name##_texels, int32_t(i)); }
#define WORDS(bind, T, name)                                          \
  layout(set = 0, binding = bind) uniform usamplerBuffer name##_texels; \
  T name(uint32_t i) { return T(texelFetch(name##_texels, int32_t(i)).x); }
#define TRIPLES(bind, T, name)                                                                   \
  layout(set = 0, binding = bind) uniform usamplerBuffer name##_texels;                            \
  T name(uint32_t i) {                                                                             \
    const int32_t at = int32_t(3u * i);                                                            \
    return T(texelFetch(name##_texels, at).x, texelFetch(name##_texels, at + 1).x,                 \
             texelFetch(name##_texels, at + 2).x);                                                 \
  }
#else
// std430 says that a texel is aligned: a GPU loads it at once.
#define TEXELS(bind, name)                                                                        \
  layout(set = 0, binding = bind, std430) readonly buffer name##_block { uvec4 name##_texels[]; }; \
  uvec4 name(uint32_t i) { return name##_texels[i]; }
#define WORDS(bind, T, name)          \
  READ(bind, T, name##_words);        \
  T name(uint32_t i) { return name##_words[i]; }
#define TRIPLES(bind, T, name)        \
  READ(bind, T, name##_triples);      \
  T name(uint32_t i) { return name##_triples[i]; }
#endif

uint32_t flat_group() { return gl_WorkGroupID.y * gl_NumWorkGroups.x + gl_WorkGroupID.x; }
uint32_t flat_invocation() { return flat_group() * kGroupSize + gl_LocalInvocationIndex; }

// Groups for n of them, along x first.
DispatchArguments groups_for(uint32_t n) {
  const uint32_t rows = (n + kMaxGroupsX - 1u) / kMaxGroupsX;
  return DispatchArguments(min(n, kMaxGroupsX), rows, 1u);
}

DispatchArguments items_for(uint32_t count) { return groups_for((count + kGroupSize - 1u) / kGroupSize); }

// floor(a / b), b > 0.
int32_t floor_div(int32_t a, int32_t b) {
  const int32_t q = a / b;
  return q - int32_t(a < q * b);
}
#endif

// What lets one header be read by GLSL (scalar layout) and by C++. Include it first; in a shader, after
// `#extension GL_GOOGLE_include_directive : require`. Types common to both: int32_t, uint32_t, int64_t,
// uint64_t, ivec3, uvec3.
#ifndef PALPATE_SHARED_BASE_H
#define PALPATE_SHARED_BASE_H

#ifdef __cplusplus
#include <cstddef>
#include <cstdint>
#include <glm/vec3.hpp>

#define PALPATE_SHARED_BEGIN namespace palpate::gpu {
#define PALPATE_SHARED_END }
/// Both compilers lay a struct out alike when size and offsets are as stated.
#define PALPATE_ASSERT_SIZE(Type, bytes) \
  static_assert(sizeof(Type) == (bytes), #Type " has another size in GLSL")
#define PALPATE_ASSERT_OFFSET(Type, member, bytes) \
  static_assert(offsetof(Type, member) == (bytes), #Type "." #member " lies elsewhere in GLSL")
#define PALPATE_CONSTANT inline constexpr

PALPATE_SHARED_BEGIN
using glm::ivec3;
using glm::uvec3;
using std::int32_t;
using std::int64_t;
using std::uint32_t;
using std::uint64_t;
PALPATE_SHARED_END

#else
#extension GL_EXT_shader_explicit_arithmetic_types_int32 : require
#extension GL_EXT_shader_explicit_arithmetic_types_int64 : require
#extension GL_EXT_shader_atomic_int64 : require
#extension GL_EXT_scalar_block_layout : require
#define PALPATE_SHARED_BEGIN
#define PALPATE_SHARED_END
#define PALPATE_ASSERT_SIZE(Type, bytes)
#define PALPATE_ASSERT_OFFSET(Type, member, bytes)
#define PALPATE_CONSTANT const
#endif

PALPATE_SHARED_BEGIN
// Workgroup of a shader that handles one item an invocation: layout(local_size_x = kItemGroup).
PALPATE_CONSTANT uint32_t kItemGroup = 64u;
PALPATE_SHARED_END

#endif

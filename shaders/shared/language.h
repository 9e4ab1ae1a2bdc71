// What lets one header be read by GLSL (scalar block layout) and by C++: the names of the types, and where they live.
#ifndef PALPATE_SHADERS_SHARED_LANGUAGE_H
#define PALPATE_SHADERS_SHARED_LANGUAGE_H
#ifdef __cplusplus
#include <cstdint>

#include "model/vector.h"

namespace palpate::shared {
using uint = std::uint32_t;
using int64_t = std::int64_t;
using uint64_t = std::uint64_t;
using ivec3 = Int3;
using uvec2 = glm::uvec2;
using uvec3 = glm::uvec3;
using uvec4 = glm::uvec4;
}  // namespace palpate::shared
#define PALPATE_SHARED_BEGIN namespace palpate::shared {
#define PALPATE_SHARED_END }
#define PALPATE_CONST inline constexpr
#else
#define PALPATE_SHARED_BEGIN
#define PALPATE_SHARED_END
#define PALPATE_CONST const
#endif
#endif

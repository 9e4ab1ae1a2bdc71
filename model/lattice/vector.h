#pragma once
#include <cstdint>
#include <glm/geometric.hpp>
#include <glm/gtc/quaternion.hpp>
#include <glm/mat3x3.hpp>
#include <glm/vec3.hpp>

namespace palpate {

using Vec3 = glm::dvec3;     ///< metres, newtons, … in double precision
using Quat = glm::dquat;     ///< GLM order of construction: (w, x, y, z)
using Int3 = glm::ivec3;     ///< a lattice point or an integer direction, 32 bits a component
using Long3 = glm::i64vec3;  ///< sums of lattice points, raw normals

}  // namespace palpate

#pragma once
#include <cstdint>

#include "model/generate.h"

namespace palpate {

/// Chapter 4.1: two parallelepipeds, a central cylinder, a clamp that meets them in one, two and four areas.
GeneratedScene generate_contacts(std::uint64_t triangles, std::uint64_t tool_triangles);

/// Chapter 4.2: a clamp is drawn off a bent pipe, in six stages, on the rig with one force and three torques.
GeneratedScene generate_disassembly(std::uint64_t triangles, std::uint64_t tool_triangles);

}  // namespace palpate

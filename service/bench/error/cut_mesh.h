#pragma once
#include <cstdint>

#include "model/mesh/mesh.h"

namespace palpate {

/// The same surface in about so many triangles, never more: edges longer than some length get a vertex in
/// their middle, again and again, the same in both triangles that share one. As it is where that is no more.
Mesh cut_to(const Mesh& mesh, std::uint64_t triangles);

}  // namespace palpate

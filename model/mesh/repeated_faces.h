#pragma once
#include <cstdint>
#include <span>

#include "model/lattice/lattice_mesh.h"

namespace palpate {

/// Sets kTriangleRepeated, so that what stands there twice pushes once (docs/EXACTNESS.md section 4).
/// `part_of` numbers the part of every triangle; neighbours and sheets must be there.
void mark_repeated_faces(std::span<const std::uint32_t> part_of, LatticeMesh& mesh);

}  // namespace palpate

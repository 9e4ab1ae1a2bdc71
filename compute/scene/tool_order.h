#pragma once
#include <cstdint>
#include <vector>

#include "model/lattice/lattice_mesh.h"

namespace palpate {

/// Ids of all triangles of a body, neighbours in space near each other: along a Morton curve through their
/// centroids, ties by id. Runs of it are clusters with small boxes. Allocates.
std::vector<std::uint32_t> order_in_space(const LatticeMesh& mesh);

}  // namespace palpate

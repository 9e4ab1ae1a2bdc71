#pragma once
#include <array>
#include <cstdint>
#include <span>

#include "model/lattice/lattice_mesh.h"
#include "model/mesh/tips.h"

namespace palpate {

/// Fills `patch` and `patch_count`. `part_of` numbers the part of every triangle; neighbours must be there.
void find_patches(std::span<const std::uint32_t> part_of, LatticeMesh& mesh);

/// How many grid samples of at least each level a triangle has (docs/EXACTNESS.md section 4). Beyond 2^20
/// cells: about how many, by its area.
std::array<double, kSampleLevels + 1> count_samples(const LatticeMesh& mesh, std::uint32_t triangle,
                                                    std::int32_t spacing);

/// Fills `field_weight_q30` and `extra_samples`, so that what the grid misses of small and thin faces and of
/// tips is felt, too, and the levels of large ones (EXACTNESS section 4). `tips` are find_tips()'s of the
/// same spacing, steps; patches must be there. Double precision in a fixed order: made once at load, read by
/// every back end.
void weigh_for_field(std::int32_t spacing, std::span<const Tip> tips, LatticeMesh& mesh);

/// Fills `grid_samples` of a tool: how many samples of each triangle weigh something, cut so that all
/// together are below 2^32 (EXACTNESS section 4). Its field weights must be there.
void count_grid_samples(std::int32_t spacing, LatticeMesh& tool);

/// Sets kTriangleThin on the triangles of tips and on those of pieces, joined over edges, that are closed and
/// whose width 4 V / A is below 9 spacings (EXACTNESS section 4). Neighbours must be there.
void mark_thin_pieces(std::int32_t spacing, std::span<const Tip> tips, LatticeMesh& mesh);

}  // namespace palpate

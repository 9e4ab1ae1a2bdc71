#pragma once
#include <cstdint>
#include <vector>

#include "model/lattice/lattice_mesh.h"

namespace palpate {

/// The triangles round a pointed corner of a body, such as a cone's sides.
struct Tip {
  std::uint32_t apex = 0;                ///< vertex
  std::vector<std::uint32_t> triangles;  ///< in their order round it
};

/// A body's tips, by ascending apex: corners that point out of it, whose triangles close round them, leave
/// less than half a turn between them and face ways that mostly cancel. No triangle is of two tips: the one
/// with the smaller apex has it, and the other is none. Those too large for samples of their own are left out
/// (docs/EXACTNESS.md section 4). `spacing` of samples, steps.
std::vector<Tip> find_tips(std::int32_t spacing, const LatticeMesh& mesh);

/// Adds extra samples for all of a tip's area, in rings: the closer to the apex, the closer together.
void sample_tip(std::int32_t spacing, const Tip& tip, LatticeMesh& mesh);

}  // namespace palpate

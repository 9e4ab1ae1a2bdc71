#pragma once
#include <cstdint>
#include <optional>

#include "cpu_ref/frame.h"

namespace palpate::cpu_ref {

/// How far a point lies below a body's surface, and below which triangle.
struct Depth {
  std::uint32_t steps = 0;     ///< φ
  std::uint32_t triangle = 0;  ///< the nearest one; of several the smallest id
};

/// Distance between a lattice point and a triangle of `mesh` that did not collapse (EXACTNESS section 4,
/// "Depth").
std::uint32_t distance(const LatticeMesh& mesh, std::uint32_t triangle, const Int3& point);

/// The unit way from a point to the nearest one of a triangle that is `steps` away, Q30, as the triangle's
/// normal where it is next to nothing (EXACTNESS section 4, "Way out").
Int3 way_out(const LatticeMesh& mesh, std::uint32_t triangle, std::uint32_t steps, const Int3& point);

/// The nearest triangle that bounds a solid: neither collapsed nor of a sheet. `tree` holds the boxes of
/// `mesh`'s triangles.
std::optional<Depth> nearest(const LatticeMesh& mesh, const BoxTree& tree, const Int3& point);

/// Whether a world lattice point lies inside the mock-up.
bool inside_mockup(const Frame& frame, const Int3& point);

}  // namespace palpate::cpu_ref

#pragma once
#include <array>
#include <cstdint>
#include <vector>

#include "compute/scene/triangle_tree.h"
#include "model/lattice/lattice_mesh.h"

namespace palpate::native {

/// How far points far from a body are from its surface at least, nearly as far as they are: distances at the
/// nodes of a coarse lattice, which tell of all between them. |x − s|² − |x|² is linear in x for each point s
/// of the surface, so their least is concave, and nowhere below what is interpolated between the corners of a
/// cube. That is off by a square of the spacing over the distance. Made once a scene, read by any number of
/// threads.
class DistanceLattice {
 public:
  static constexpr std::uint32_t kMostNodes = 1u
                                              << 16;  ///< chosen: a quarter of a MiB, and a tenth of a second

  /// About a mesh and `margin` steps around it. `tree`: of its triangles, which is empty where they are none.
  /// Allocates; on all cores.
  DistanceLattice(const LatticeMesh& mesh, const TriangleTree& tree, double margin);

  /// Square of a point's distance, steps, that it has at least.
  double squared(const std::array<double, 3>& point) const;

  std::uint64_t bytes() const { return sizeof squared_[0] * std::uint64_t{squared_.size()}; }

 private:
  double low_[3]{}, spacing_ = 1, per_spacing_ = 1;  ///< steps
  std::uint32_t count_[3]{2, 2, 2};                  ///< nodes along the axes
  std::vector<float> squared_;                       ///< of each node's distance, x first; rounded down
};

}  // namespace palpate::native

#pragma once
#include <cstdint>
#include <span>
#include <vector>

#include "model/lattice/lattice_mesh.h"
#include "model/mesh/smooth_angle.h"
#include "model/result.h"

namespace palpate {

/// Most triangles that may share one edge: each is every other's neighbour, so their number counts squared
/// (chosen).
inline constexpr std::size_t kMaxTrianglesOnEdge = 4096;

/// A triangle on the edge between a vertex (known from where this is kept) and a higher one.
struct EdgeUse {
  std::uint32_t high_vertex = 0;
  std::uint32_t triangle = 0;
};

/// All edges of the triangles with three distinct vertices, as flat arrays: uses sorted by lower vertex,
/// higher vertex, triangle. Triangles that collapsed to a line are in it: they have no area, but they connect
/// what lies at their long edge with what lies at the two short ones. Does not depend on how triangles are
/// turned, so it survives orientation.
class EdgeTable {
 public:
  explicit EdgeTable(const LatticeMesh& mesh);

  /// Calls visit(low vertex, uses) for every edge, ascending; `uses` are the triangles on it, ascending.
  template <class Visit>
  void for_each(Visit visit) const {
    for (std::uint32_t low = 0; low + 1 < begin_.size(); ++low)
      for (std::size_t i = begin_[low]; i < begin_[low + 1];) {
        std::size_t end = i + 1;
        while (end < begin_[low + 1] && uses_[end].high_vertex == uses_[i].high_vertex) ++end;
        visit(low, std::span<const EdgeUse>(&uses_[i], end - i));
        i = end;
      }
  }

 private:
  std::vector<std::uint32_t> begin_;  ///< CSR over the lower vertex
  std::vector<EdgeUse> uses_;
};

/// Whether the triangle runs along the edge from `low` to `high` (+1) or from `high` to `low` (−1).
int edge_direction(const LatticeMesh& mesh, std::uint32_t triangle, std::uint32_t low, std::uint32_t high);

/// Error (kBadValue): an edge with more than kMaxTrianglesOnEdge triangles that did not collapse. Asked
/// before a mesh is oriented: rays through a pile of a million coincident triangles would each cross all of
/// them.
Result<void> check_crowded_edges(const EdgeTable& edges, const LatticeMesh& mesh);

/// Fills `neighbours` and `neighbour_begin`; collapsed triangles are nobody's neighbours. Requires
/// check_crowded_edges. Error (kBadValue): more pairs of neighbours than memory is kept for.
Result<void> find_neighbours(const EdgeTable& edges, const SmoothAngle& angle, LatticeMesh& mesh);

/// Fills `closed` of the mesh, and of the report open and non-manifold edges, duplicates, the largest gap and
/// which parts are closed by themselves; collapsed triangles are left out. `part_of` gives each triangle's
/// place in report.parts.
void examine_edges(const EdgeTable& edges, double step_m, std::span<const std::uint32_t> part_of,
                   LatticeMesh& mesh, MeshReport& report);

}  // namespace palpate

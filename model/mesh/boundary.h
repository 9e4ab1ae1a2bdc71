#pragma once
#include <array>
#include <cstdint>
#include <vector>

#include "model/lattice/lattice_mesh.h"

namespace palpate {

/// The edges at which a surface does not cancel vertex for vertex, and whether they cancel point for point.
/// They do where one side of a seam has vertices that the other lacks: windings are then as whole as in a
/// mesh without such T-junctions.
class Boundary {
 public:
  /// An edge whose uses from `low` to `high`, less those from `high` to `low`, are `incidence` ≠ 0.
  void add(const LatticeMesh& mesh, std::uint32_t low, std::uint32_t high, int incidence);

  /// Whether all edges cancel; of those on lines where some do not, the loops' largest extent is kept. Call
  /// once.
  bool cancels(const LatticeMesh& mesh);

  /// After cancels(): the largest diagonal of the bounding box of a loop of boundary edges, in steps.
  double largest_gap() const { return largest_gap_; }

 private:
  /// One end of an edge on its line. The line is known by its direction, shortest and lexicographically
  /// positive, and moment.
  struct End {
    Int3 direction{0};
    Long3 moment{0};          ///< p × direction: below 2^58.1
    std::int32_t place = 0;   ///< along the line: the end's coordinate on the direction's first non-zero axis
    std::int32_t change = 0;  ///< by how much the number of edges over the line's points changes here
    std::array<std::uint32_t, 2> edge{};
  };
  std::vector<End> ends_;
  double largest_gap_ = 0;
};

}  // namespace palpate

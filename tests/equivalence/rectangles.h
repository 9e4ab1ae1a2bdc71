#pragma once
#include <vector>

#include "model/lattice/vector.h"
#include "model/lattice/voxel_grid.h"

namespace palpate::equivalence {

/// A closed box along the axes; `winding` is what being within it adds, +1 outward, −1 inward.
struct WeightedBox {
  Int3 min{0}, max{0};
  int winding = 1;
};

/// Boxes and rectangles along the axes, of which the class of a cube can be said by comparing coordinates
/// alone.
class RectangleWorld {
 public:
  void add(const WeightedBox& box);
  /// A rectangle alone: its box is flat along one axis.
  void add_sheet(const Int3& min, const Int3& max) { faces_.push_back({min, max}); }
  /// Takes a face (2·axis + upper) of the first box away: nothing is enclosed by it any more, for the face is
  /// many voxels wide.
  void open(int face);
  /// Takes away the first triangle of a lower z face of the first box, whose other half is that with y ≥ x
  /// from corner to corner.
  void open_half(int face);

  /// V_bnd when the closed cube meets a rectangle; else V_int when its windings do not add up to 0; else
  /// V_ext. Cubes that are not V_bnd lie wholly within or wholly without each box.
  VoxelClass class_of(const Int3& lower, std::int32_t size) const;

 private:
  struct Face {
    Int3 min, max;
    bool half = false;
  };
  std::vector<WeightedBox> boxes_;
  std::vector<Face> faces_;
};

}  // namespace palpate::equivalence

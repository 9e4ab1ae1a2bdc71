#include "tests/equivalence/rectangles.h"

#include <algorithm>
#include <cstddef>

namespace palpate::equivalence {

void RectangleWorld::add(const WeightedBox& box) {
  boxes_.push_back(box);
  for (int axis = 0; axis < 3; ++axis)
    for (const bool upper : {false, true}) {
      Face face{box.min, box.max};
      (upper ? face.min : face.max)[axis] = upper ? box.max[axis] : box.min[axis];
      faces_.push_back(face);
    }
}

void RectangleWorld::open(int face) {
  boxes_[0].winding = 0;
  faces_.erase(faces_.begin() + face);
}

void RectangleWorld::open_half(int face) {
  boxes_[0].winding = 0;
  faces_[static_cast<std::size_t>(face)].half = true;
}

VoxelClass RectangleWorld::class_of(const Int3& lower, std::int32_t size) const {
  const Int3 upper = lower + Int3(size);
  for (const Face& face : faces_) {
    bool meets = true;
    for (int k = 0; k < 3; ++k) meets = meets && lower[k] <= face.max[k] && upper[k] >= face.min[k];
    // The half with y ≥ x of a square: the cube's point of least x and most y within the square decides.
    if (meets && face.half)
      meets = std::min(upper.y, face.max.y) - face.min.y >= std::max(lower.x, face.min.x) - face.min.x;
    if (meets) return VoxelClass::kBoundary;
  }
  int winding = 0;
  for (const WeightedBox& box : boxes_) {
    bool within = true;
    for (int k = 0; k < 3; ++k) within = within && box.min[k] < lower[k] && upper[k] < box.max[k];
    winding += within ? box.winding : 0;
  }
  return winding != 0 ? VoxelClass::kInternal : VoxelClass::kExternal;
}

}  // namespace palpate::equivalence

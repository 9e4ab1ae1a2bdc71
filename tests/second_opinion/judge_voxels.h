#pragma once
#include <cstddef>
#include <string>
#include <vector>

#include "tests/second_opinion/exported.h"

namespace second_opinion {

struct VoxelVerdict {
  bool closed = false;       ///< directed edges cancel: inside and outside were judged
  std::size_t boundary = 0;  ///< V_bnd voxels by CGAL
  std::size_t missing_boundary = 0, extra_boundary = 0;
  std::size_t judged = 0;        ///< centres of other voxels whose winding was counted
  std::size_t internal = 0;      ///< of these, not 0
  std::size_t wrong = 0;         ///< of these, in another class than palpate says
  std::string first_difference;  ///< a sentence; empty if there is none
};

/// Judges every V_bnd voxel (closed cube meets closed triangle), and of a closed mock-up every `stride`-th
/// other voxel by the winding of its centre, which no triangle holds (docs/EXACTNESS.md section 2): the signs
/// of the crossings along a ray of general direction.
VoxelVerdict judge_voxels(const std::vector<Triangle>& statics, const Voxels& voxels, std::size_t stride);

}  // namespace second_opinion

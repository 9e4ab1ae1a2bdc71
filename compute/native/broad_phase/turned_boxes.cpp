#include "compute/native/broad_phase/turned_boxes.h"

#include <cstring>

#include "compute/native/processor.h"

namespace palpate {
namespace {

namespace plain {
constexpr std::size_t kWidth = 4;
#include "compute/native/broad_phase/turned_boxes_simd.h"
}  // namespace plain
#if PALPATE_TWO_CODES
PALPATE_SECOND_CODE_BEGIN
namespace second {
constexpr std::size_t kWidth = 8;
#include "compute/native/broad_phase/turned_boxes_simd.h"
}  // namespace second
PALPATE_SECOND_CODE_END
#endif

}  // namespace

void voxels_of(const VoxelTurn& turn, const EightBoxes& boxes, EightRanges& out) {
#if PALPATE_TWO_CODES
  if (has_second_code()) return second::of_boxes(turn, boxes, out);
#endif
  plain::of_boxes(turn, boxes, out);
}

void voxels_of(const VoxelTurn& turn, const EightTriangles& triangles, EightRanges& out) {
#if PALPATE_TWO_CODES
  if (has_second_code()) return second::of_triangles(turn, triangles, out);
#endif
  plain::of_triangles(turn, triangles, out);
}

}  // namespace palpate

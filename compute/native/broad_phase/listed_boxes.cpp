#include "compute/native/broad_phase/listed_boxes.h"

#include <algorithm>
#include <cstring>

#include "compute/native/broad_phase/turned_boxes.h"
#include "compute/native/processor.h"
#include "compute/scene/search_tables.h"

namespace palpate {
namespace {

// Sixteen boxes at a time.
constexpr std::size_t kLanes = SearchTables::kBoxesAtOnce;
using Bytes = std::uint8_t __attribute__((vector_size(kLanes)));
using Halves = std::uint64_t __attribute__((vector_size(kLanes)));
using Four = std::int32_t __attribute__((vector_size(kLanes)));

/// Where the coordinates of the boxes' corners lie that are furthest behind a plane, and furthest before it.
struct PlaneRows {
  const std::uint8_t *behind[3], *before[3];
};

namespace plain {
constexpr std::size_t kWidth = 4;
static void spread(const Four& four, Four& out) { out = four; }
static Four gather(const Four& words) { return words; }
#include "compute/native/broad_phase/listed_boxes_simd.h"
}  // namespace plain
#if PALPATE_TWO_CODES
PALPATE_SECOND_CODE_BEGIN
namespace second {
constexpr std::size_t kWidth = 8;
using Twice = std::int32_t __attribute__((vector_size(2 * kLanes)));
static void spread(const Four& four, Twice& out) {
  out = __builtin_shufflevector(four, four, 0, 1, 2, 3, 0, 1, 2, 3);
}
static Four gather(const Twice& words) {
  return __builtin_shufflevector(words, words, 0, 1, 2, 3) |
         __builtin_shufflevector(words, words, 4, 5, 6, 7);
}
#include "compute/native/broad_phase/listed_boxes_simd.h"
}  // namespace second
PALPATE_SECOND_CODE_END
#endif

}  // namespace

std::uint64_t near_boxes(const ListLook& look, const std::uint8_t* boxes, std::size_t stride,
                         std::size_t count) {
#if PALPATE_TWO_CODES
  if (has_second_code()) return second::near_boxes(look, boxes, stride, count);
#endif
  return plain::near_boxes(look, boxes, stride, count);
}

}  // namespace palpate

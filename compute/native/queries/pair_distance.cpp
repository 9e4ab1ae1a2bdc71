#include "compute/native/queries/pair_distance.h"

#include <cmath>
#include <cstring>

#include "compute/native/processor.h"

namespace palpate::native {
namespace {

namespace plain {
constexpr std::size_t kWidth = 2;
#include "compute/native/queries/pair_simd.h"
}  // namespace plain
#if PALPATE_TWO_CODES
PALPATE_SECOND_CODE_BEGIN
namespace second {
constexpr std::size_t kWidth = 4;
#include "compute/native/queries/pair_simd.h"
}  // namespace second
PALPATE_SECOND_CODE_END
#endif

}  // namespace

void distances(const PairLanes& lanes, PairDistances& out) {
#if PALPATE_TWO_CODES
  if (has_second_code()) return second::judge_lanes(lanes, out);
#endif
  plain::judge_lanes(lanes, out);
}

unsigned may_meet(const PairLanes& lanes, const PairMotion& motion) {
#if PALPATE_TWO_CODES
  if (has_second_code()) return second::may_meet_lanes(lanes, motion);
#endif
  return plain::may_meet_lanes(lanes, motion);
}

void rooms(const PairLanes& lanes, std::array<double, kLanes>& squared) {
#if PALPATE_TWO_CODES
  if (has_second_code()) return second::room_lanes(lanes, squared);
#endif
  plain::room_lanes(lanes, squared);
}

void turned_gaps(const std::array<double, 9>& corners, const TriangleTree::TurnedBoxes& boxes,
                 std::array<double, kLanes>& squared) {
#if PALPATE_TWO_CODES
  if (has_second_code()) return second::turned_gaps(corners, boxes, squared);
#endif
  plain::turned_gaps(corners, boxes, squared);
}

void box_gaps(const BoxOf& box, const TriangleTree::Boxes& boxes, std::array<double, kLanes>& squared) {
#if PALPATE_TWO_CODES
  if (has_second_code())
    return second::gaps_between(box.low.data(), box.high.data(), boxes.low[0].data(), boxes.high[0].data(),
                                squared.data());
#endif
  plain::gaps_between(box.low.data(), box.high.data(), boxes.low[0].data(), boxes.high[0].data(),
                      squared.data());
}

}  // namespace palpate::native

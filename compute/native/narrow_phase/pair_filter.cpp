#include "compute/native/narrow_phase/pair_filter.h"

#include <cstring>

#include "compute/native/processor.h"

namespace palpate {
namespace {

constexpr std::size_t kLanes = PairFilter::kLanes;
using Coordinates = PairFilter::Coordinates;

// What is computed differs from its exact value by less than 104 · 2^-24 of a product of three sizes
// (pair_filter_simd.h), which itself is rounded four times.
constexpr float kBound = 0x1p-17F;

namespace plain {
constexpr std::size_t kWidth = 4;
#include "compute/native/narrow_phase/pair_filter_simd.h"
}  // namespace plain
#if PALPATE_TWO_CODES
PALPATE_SECOND_CODE_BEGIN
namespace second {
constexpr std::size_t kWidth = 8;
#include "compute/native/narrow_phase/pair_filter_simd.h"
}  // namespace second
PALPATE_SECOND_CODE_END
#endif

}  // namespace

void PairFilter::judge(std::array<Verdict, kLanes>& out) const {
#if PALPATE_TWO_CODES
  if (has_second_code()) return second::judge_lanes(s_, t_, out.data());
#endif
  plain::judge_lanes(s_, t_, out.data());
}

}  // namespace palpate

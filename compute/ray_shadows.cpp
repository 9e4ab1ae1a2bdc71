#include "compute/ray_shadows.h"

#include <cstring>

#include "compute/processor.h"

namespace palpate {
namespace {

// Let ε be 2^-53, R the reach, L the longest side of a triangle's box. Differences of coordinates are exact. A sheared coordinate is off by the
// quotient's ε, the product's and the difference's, which is within twice what is sheared: by less than 4.01 ε of it.
//   x and y of a ray or corner: within 2 R, off by 4.01 ε R.
//   a, b: within 2 L, off by 4.01 ε L.
//   Their products: off by 8.02 ε L R for each factor and by 4 ε L R as rounded, 20.1 ε L R. c: two of them, and 8 ε L R for the sum.
//   a·x + b·y + c: two more, and 8 and 16 ε L R for the sums. All together: below 114 ε L R.
constexpr double kBound = 0x1p-46;   // 128 ε
constexpr double kSlack = 0x1p-49;   // 16 ε: more than ray and corner together
constexpr std::uint32_t kMany = 16;  // rays in a row of squares, beyond which a triangle's part of the row is found first (chosen)

namespace plain {
constexpr std::size_t kWidth = 2;
#include "compute/ray_shadows_lanes.h"
}
#if PALPATE_TWO_CODES
PALPATE_SECOND_CODE_BEGIN
namespace second {
constexpr std::size_t kWidth = 4;
#include "compute/ray_shadows_lanes.h"
}
PALPATE_SECOND_CODE_END
#endif

}  // namespace

void see(const RayView& view, EightShadows& triangles) {
#if PALPATE_TWO_CODES
  if (has_second_code()) return second::see_lanes(view, triangles);
#endif
  plain::see_lanes(view, triangles);
}

std::size_t rays_met(const RayView& view, const RayRows& rows, const EightShadows& triangles, std::size_t i, std::uint32_t* out) {
#if PALPATE_TWO_CODES
  if (has_second_code()) return second::meet_rows(view, rows, triangles, i, out);
#endif
  return plain::meet_rows(view, rows, triangles, i, out);
}

}  // namespace palpate

#pragma once
#include <cstdint>

#include "cpu_ref/exact.h"

namespace palpate::cpu_ref {

/// How far two triangles that share no point are apart (EXACTNESS section 10).
struct TriangleDistance {
  std::int32_t steps = 0;  ///< floor
  Int3 on_s{0}, on_m{0};   ///< on the first feature that is so near, rounded to nearest
};

/// `s` is not collapsed; `m` may be a segment, which may pass through `s`: 0, without places.
TriangleDistance distance_of(const Triangle& s, const Triangle& m);

}  // namespace palpate::cpu_ref

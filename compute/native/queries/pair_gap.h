#pragma once
#include <cstdint>

#include "compute/scene/exact.h"

namespace palpate::exact {

/// How far two triangles that share no point are apart (docs/EXACTNESS.md, section 10). Neither is collapsed;
/// coordinates as exact.h has them.
struct Gap {
  std::int32_t steps;  ///< floor of the distance
  int feature;         ///< the first that is so near
};

/// `most`: features further than that many steps need not be told apart; `steps` is then more than `most`.
Gap gap(const Corners& s, const Corners& m, std::int32_t most);

/// The nearest points of the two, each rounded to nearest, on the given feature, which gap() has named.
void witnesses(const Corners& s, const Corners& m, int feature, Int3& on_s, Int3& on_m);

}  // namespace palpate::exact

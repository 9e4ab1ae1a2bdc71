#pragma once
#include "model/contact/field.h"

namespace palpate {

constexpr double kQ30 = 1073741824.0;  ///< 2^30: what fixed-point heights and normals are divided by

inline double to_double(const WideSum& sum) {
  return static_cast<double>(sum.high) * 4294967296.0 + static_cast<double>(sum.low);
}

}  // namespace palpate

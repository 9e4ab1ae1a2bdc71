#pragma once
#include "model/contact/field.h"

namespace palpate {

inline double to_double(const WideSum& sum) {
  return static_cast<double>(sum.high) * 4294967296.0 + static_cast<double>(sum.low);
}

}  // namespace palpate

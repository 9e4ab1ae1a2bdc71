#pragma once
#include <stdexcept>
#include <utility>

#include "model/result.h"

namespace palpate::mutation {

/// What a result holds; throws std::runtime_error with the sentence of one that failed.
template <class T>
T must(Result<T> result) {
  if (!result) throw std::runtime_error(result.error().sentence);
  return std::move(*result);
}
inline void must(const Result<void>& result) {
  if (!result) throw std::runtime_error(result.error().sentence);
}

}  // namespace palpate::mutation

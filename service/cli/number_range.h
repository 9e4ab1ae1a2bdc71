#pragma once
#include <fmt/format.h>
#include <CLI/Error.hpp>
#include <functional>

namespace palpate {

/// Takes the value of an option `name` that is a number from `least` to `most` into `out`, which outlives the
/// parsing. CLI::Range would let nan pass.
inline std::function<void(const double&)> number_within(const char* name, double least, double most,
                                                        double& out) {
  return [=, &out](const double& value) {
    if (!(value >= least && value <= most))
      throw CLI::ValidationError(name, fmt::format("{} is not from {} to {}", value, least, most));
    out = value;
  };
}

}  // namespace palpate

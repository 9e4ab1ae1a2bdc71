#pragma once
#include <fmt/format.h>
#include <CLI/Validators.hpp>
#include <cstdlib>
#include <string>

namespace palpate {

/// For an option that is a number: from `least` to `most`, and one at all. CLI::Range would let nan pass.
inline CLI::Validator within_numbers(double least, double most) {
  return CLI::Validator(
      [=](std::string& text) {
        char* end = nullptr;
        const double value = std::strtod(text.c_str(), &end);
        const bool inside = end != text.c_str() && *end == '\0' && value >= least && value <= most;
        return inside ? std::string() : fmt::format("{} is not from {} to {}", text, least, most);
      },
      "");
}

}  // namespace palpate

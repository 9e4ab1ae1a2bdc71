#pragma once
#include <cstdint>
#include <string>

namespace palpate {

/// 1234567 → "1,234,567".
std::string count_text(std::uint64_t count);

/// 0 → "–", 1536 → "1.5 KiB".
std::string bytes_text(std::uint64_t bytes);

/// A length in the unit that fits it: "0.52 mm", "31 nm".
std::string length_text(double metres);

}  // namespace palpate

#pragma once
#include <cstdint>

namespace palpate::equivalence {

/// Numbers for scenes and poses (splitmix64): the same on every machine and with every standard library, so
/// that stored hashes stay comparable.
class Random {
 public:
  explicit Random(std::uint64_t seed) : state_(seed) {}
  /// The numbers of pose `index` alone, so that one pose can be repeated without those before it.
  Random(std::uint64_t seed, std::uint64_t index) : state_(seed * 0xD1342543DE82EF95u + index) {
    state_ = bits();
  }

  std::uint64_t bits() {
    std::uint64_t z = state_ += 0x9E3779B97F4A7C15u;
    z = (z ^ (z >> 30)) * 0xBF58476D1CE4E5B9u;
    z = (z ^ (z >> 27)) * 0x94D049BB133111EBu;
    return z ^ (z >> 31);
  }
  /// 0 … count − 1; count > 0.
  std::uint64_t below(std::uint64_t count) { return bits() % count; }
  /// low … high, both included.
  std::int32_t between(std::int32_t low, std::int32_t high) {
    return static_cast<std::int32_t>(
        low + static_cast<std::int64_t>(below(static_cast<std::uint64_t>(std::int64_t{high} - low + 1))));
  }
  /// [0, 1), 53 bits.
  double unit() { return static_cast<double>(bits() >> 11) * 0x1p-53; }
  /// Mean 0, variance 1, within ±√12: the sum of four even numbers, so without a function that may differ
  /// between C libraries.
  double bell() { return (unit() + unit() + unit() + unit() - 2) * 1.7320508075688772; }

 private:
  std::uint64_t state_;
};

}  // namespace palpate::equivalence

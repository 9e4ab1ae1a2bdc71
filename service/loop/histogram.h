#pragma once
#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <cstddef>
#include <cstdint>

namespace palpate {

/// Counts of non-negative integers in fixed memory (30 kB): exact below 128, else in buckets 1/64 of their
/// value wide, so a percentile is within 1.6 %; the largest value is kept exactly. add() never allocates or
/// branches on history.
class Histogram {
 public:
  void add(std::int64_t value) noexcept {
    const auto v = static_cast<std::uint64_t>(std::max<std::int64_t>(value, 0));
    ++counts_[bucket(v)];
    ++total_;
    max_ = std::max(max_, v);
  }

  std::uint64_t total() const { return total_; }
  double max() const { return static_cast<double>(max_); }

  /// Smallest recorded value that `share` of all values don't exceed (nearest rank), as its bucket's middle;
  /// 0 if empty.
  double percentile(double share) const {
    if (total_ == 0) return 0;
    const auto rank = static_cast<std::uint64_t>(std::ceil(share * static_cast<double>(total_)));
    if (rank >= total_) return max();
    std::uint64_t seen = 0;
    for (std::size_t i = 0; i < counts_.size(); ++i) {
      seen += counts_[i];
      if (seen >= std::max<std::uint64_t>(rank, 1)) return std::min(middle(i), max());
    }
    return max();
  }

  /// Calls `take(low, high, count)` for what is in [low, high), ascending, without empty ones: each value
  /// below 128 by itself or, `coarse`, in one; above in quarters of an octave, or as kept.
  template <class Take>
  void each(bool coarse, Take take) const {
    const std::size_t together = coarse ? kPerOctave / 4 : 1;
    std::size_t next = 0;
    for (std::size_t i = 0; i < counts_.size(); i = next) {
      next = i + (coarse && i < kExact ? kExact : together);
      std::uint64_t count = 0;
      for (std::size_t k = i; k < std::min(next, counts_.size()); ++k) count += counts_[k];
      if (count > 0) take(low(i), low(next), count);
    }
  }

 private:
  static constexpr std::size_t kExact = 128, kPerOctave = 64;

  static std::size_t bucket(std::uint64_t v) noexcept {
    if (v < kExact) return static_cast<std::size_t>(v);
    const auto shift = static_cast<std::size_t>(std::bit_width(v)) - 7;  // ≥ 1; v >> shift is in [64, 128)
    return kExact + (shift - 1) * kPerOctave + static_cast<std::size_t>(v >> shift) - kPerOctave;
  }
  static double low(std::size_t i) {
    if (i < kExact) return static_cast<double>(i);
    return std::ldexp(static_cast<double>((i - kExact) % kPerOctave + kPerOctave),
                      static_cast<int>((i - kExact) / kPerOctave + 1));
  }
  static double middle(std::size_t i) {
    if (i < kExact) return static_cast<double>(i);
    const std::size_t shift = (i - kExact) / kPerOctave + 1, top = (i - kExact) % kPerOctave + kPerOctave;
    return std::ldexp(static_cast<double>(top) + 0.5, static_cast<int>(shift));
  }

  std::array<std::uint64_t, kExact + 57 * kPerOctave> counts_{};
  std::uint64_t total_ = 0, max_ = 0;
};

}  // namespace palpate

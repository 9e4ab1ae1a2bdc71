#pragma once
#include <array>
#include <complex>
#include <cstdint>
#include <map>
#include <string>
#include <vector>

#include "model/lattice/lattice.h"

namespace palpate {

/// How rough a force is, in bounded memory: its steps from one tick to the next, counted by size, and its
/// spectrum.
class ForceSteps {
 public:
  static constexpr double kSmallest = 1e-6;      ///< N: smaller steps count as none
  static constexpr std::size_t kSegment = 1024;  ///< ticks of a piece of the spectrum: bins of 0.98 Hz

  /// The force of the next tick, N. A force that is not finite counts as 0.
  void push(const Vec3& force);

  /// JSON `[[low, high, count], …]`, N, eight bins a decade, ascending, without empty ones.
  void append_steps(std::string& out) const;
  std::uint64_t still() const { return still_; }  ///< steps of none
  double largest() const { return largest_; }     ///< step, N

  /// JSON `[[Hz, N²/Hz], …]` to 500 Hz: one-sided power spectral density, summed over the three components,
  /// by Welch's method (half overlapping pieces of kSegment ticks, each without its mean, Hann's window).
  /// Empty before a whole piece.
  void append_spectrum(std::string& out) const;

 private:
  void take_segment();

  std::vector<Vec3> recent_;  ///< at most kSegment
  std::map<int, std::uint64_t> bins_;
  std::uint64_t still_ = 0, segments_ = 0;
  double largest_ = 0;
  bool begun_ = false;
  Vec3 last_{0};
  std::array<double, kSegment / 2 + 1> power_{};
};

}  // namespace palpate

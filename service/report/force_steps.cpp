#include "service/report/force_steps.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <iterator>
#include <utility>

namespace palpate {
namespace {

constexpr double kPi = 3.14159265358979323846;
constexpr double kTicksPerSecond = 1000;
constexpr int kBinsPerDecade = 8;

using Segment = std::array<std::complex<double>, ForceSteps::kSegment>;

/// Fourier transform in place, radix two.
void transform(Segment& values) {
  constexpr std::size_t n = ForceSteps::kSegment;
  static_assert((n & (n - 1)) == 0);
  for (std::size_t i = 1, j = 0; i < n; ++i) {
    std::size_t bit = n / 2;
    for (; j & bit; bit /= 2) j ^= bit;
    j ^= bit;
    if (i < j) std::swap(values[i], values[j]);
  }
  for (std::size_t size = 2; size <= n; size *= 2)
    for (std::size_t k = 0; k < size / 2; ++k) {
      const auto turn = std::polar(1.0, -2 * kPi * static_cast<double>(k) / static_cast<double>(size));
      for (std::size_t first = k; first < n; first += size) {
        const auto other = values[first + size / 2] * turn;
        values[first + size / 2] = values[first] - other;
        values[first] += other;
      }
    }
}

}  // namespace

void ForceSteps::push(const Vec3& force) {
  Vec3 finite = force;
  for (int i = 0; i < 3; ++i)
    if (!std::isfinite(finite[i])) finite[i] = 0;
  if (begun_) {
    const double step = glm::length(finite - last_);
    largest_ = std::max(largest_, step);
    if (step < kSmallest)
      ++still_;
    else
      ++bins_[static_cast<int>(std::floor(std::log10(step) * kBinsPerDecade))];
  }
  begun_ = true;
  last_ = finite;
  recent_.push_back(finite);
  if (recent_.size() == kSegment) take_segment();
}

void ForceSteps::take_segment() {
  Vec3 mean(0);
  for (const Vec3& f : recent_) mean += f;
  mean /= static_cast<double>(kSegment);
  double weight = 0;
  for (int axis = 0; axis < 3; ++axis) {
    Segment values;
    weight = 0;
    for (std::size_t i = 0; i < kSegment; ++i) {
      const double window = 0.5 - 0.5 * std::cos(2 * kPi * static_cast<double>(i) / kSegment);
      values[i] = window * (recent_[i][axis] - mean[axis]);
      weight += window * window;
    }
    transform(values);
    for (std::size_t k = 0; k < power_.size(); ++k) {
      const double sides = k == 0 || k == kSegment / 2 ? 1 : 2;  // the other half is the same
      power_[k] += sides * std::norm(values[k]) / (kTicksPerSecond * weight);
    }
  }
  ++segments_;
  recent_.erase(recent_.begin(), recent_.begin() + kSegment / 2);
}

void ForceSteps::append_steps(std::string& out) const {
  out.push_back('[');
  for (const auto& [bin, count] : bins_)
    fmt::format_to(std::back_inserter(out), "{}[{:.4g},{:.4g},{}]", out.back() == '[' ? "" : ",",
                   std::pow(10, static_cast<double>(bin) / kBinsPerDecade),
                   std::pow(10, static_cast<double>(bin + 1) / kBinsPerDecade), count);
  out.push_back(']');
}

void ForceSteps::append_spectrum(std::string& out) const {
  out.push_back('[');
  if (segments_ > 0)
    for (std::size_t k = 1; k < power_.size(); ++k)
      fmt::format_to(std::back_inserter(out), "{}[{:.5g},{:.4g}]", out.back() == '[' ? "" : ",",
                     static_cast<double>(k) * kTicksPerSecond / kSegment,
                     power_[k] / static_cast<double>(segments_));
  out.push_back(']');
}

}  // namespace palpate

#include "compute/shadow_grid.h"

namespace palpate {
namespace {
constexpr std::uint32_t kMostBits = 14;      // 16,384 squares (chosen)
constexpr std::size_t kEntriesEach = 4;      // squares that a triangle lies in, on average, beyond which squares are too small (chosen)
}  // namespace

template <class Visit>
void ShadowGrid::for_squares(const Triangle& t, Visit&& visit) const {
  for (std::uint32_t v = t.first[1] >> drop_[1]; v <= t.last[1] >> drop_[1]; ++v)
    for (std::uint32_t u = t.first[0] >> drop_[0]; u <= t.last[0] >> drop_[0]; ++u) visit(u + (v << (bits_[0] - drop_[0])));
}

void ShadowGrid::begin(const std::array<double, 2>& low, const std::array<double, 2>& high, std::size_t rays) {
  low_ = low;
  high_ = high;
  bits_ = drop_ = {};
  const auto side = [&](std::size_t axis) { return (high[axis] - low[axis]) / (1u << bits_[axis]); };
  while (bits_[0] + bits_[1] < kMostBits && std::size_t{1} << (bits_[0] + bits_[1]) < rays) {
    const std::size_t longer = side(0) >= side(1) ? 0 : 1;
    if (!(side(longer) > 1)) break;   // a step
    ++bits_[longer];
  }
  for (std::size_t k = 0; k < 2; ++k) scale_[k] = bits_[k] == 0 ? 0 : (1u << bits_[k]) / (high[k] - low[k]);
  triangles_.clear();
}

void ShadowGrid::add(const RayShadow& shadow, std::uint32_t id) {
  if (shadow.low[0] > high_[0] || shadow.high[0] < low_[0] || shadow.low[1] > high_[1] || shadow.high[1] < low_[1]) return;
  Triangle& added = triangles_.emplace_back(shadow, id);
  for (std::size_t k = 0; k < 2; ++k) {
    added.first[k] = static_cast<std::uint32_t>(column(k, shadow.low[k]));
    added.last[k] = static_cast<std::uint32_t>(column(k, shadow.high[k]));
  }
}

void ShadowGrid::close() {
  const auto entries = [&] {
    std::size_t sum = 0;
    for (const Triangle& t : triangles_) {
      std::size_t squares = 1;
      for (std::size_t k = 0; k < 2; ++k) squares *= (t.last[k] >> drop_[k]) - (t.first[k] >> drop_[k]) + 1;
      sum += squares;
    }
    return sum;
  };
  while (drop_ != bits_ && entries() > kEntriesEach * triangles_.size()) {
    const std::size_t finer = bits_[0] - drop_[0] >= bits_[1] - drop_[1] ? 0 : 1;
    ++drop_[finer];
  }
  first_.assign((std::size_t{1} << (bits_[0] - drop_[0] + bits_[1] - drop_[1])) + 1, 0);
  for (const Triangle& t : triangles_) for_squares(t, [&](std::uint32_t square) { ++first_[square + 1]; });
  for (std::size_t i = 1; i < first_.size(); ++i) first_[i] += first_[i - 1];
  entries_.resize(first_.back());
  // Filled from each square's begin on; begins move by what is filled, and are moved back.
  for (std::uint32_t i = 0; i < triangles_.size(); ++i) for_squares(triangles_[i], [&](std::uint32_t square) { entries_[first_[square]++] = i; });
  for (std::size_t i = first_.size() - 1; i > 0; --i) first_[i] = first_[i - 1];
  first_[0] = 0;
}

}  // namespace palpate

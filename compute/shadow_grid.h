#pragma once
#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

namespace palpate {

/// A triangle seen along rays of one direction: its box across them, and how far ahead it reaches. Steps of the tool's lattice.
struct RayShadow {
  std::array<double, 2> low{}, high{};
  double ahead = 0;

  bool holds(const std::array<double, 2>& ray) const { return ray[0] >= low[0] && ray[0] <= high[0] && ray[1] >= low[1] && ray[1] <= high[1]; }
};

/// Triangles seen along rays of one direction, in squares of the plane across these: for many rays it costs less to sort a whole tool once than to
/// walk through it ray by ray. One thread; allocates only when there is more to keep than ever before.
class ShadowGrid {
 public:
  struct Triangle {
    RayShadow shadow;
    std::uint32_t id;
    std::array<std::uint32_t, 2> first, last;   ///< columns, closed
  };
  /// Squares for rays from `low` to `high` (steps of the tool's lattice, across them), about as many as `rays`, fewer where triangles are large beside them.
  void begin(const std::array<double, 2>& low, const std::array<double, 2>& high, std::size_t rays);
  /// Adds a triangle that some ray may meet.
  void add(const RayShadow& shadow, std::uint32_t id);
  /// No more triangles come.
  void close();
  /// After close(): numbers of all triangles whose shadow holds a ray between `low` and `high`, others among them.
  std::span<const std::uint32_t> at(const std::array<double, 2>& ray) const {
    const std::size_t square = (column(0, ray[0]) >> drop_[0]) + ((column(1, ray[1]) >> drop_[1]) << (bits_[0] - drop_[0]));
    return {entries_.data() + first_[square], entries_.data() + first_[square + 1]};
  }
  const Triangle& triangle(std::uint32_t number) const { return triangles_[number]; }

 private:
  std::size_t column(std::size_t axis, double at) const {
    return static_cast<std::size_t>(std::clamp((at - low_[axis]) * scale_[axis], 0.0, static_cast<double>((1u << bits_[axis]) - 1)));
  }
  template <class Visit>
  void for_squares(const Triangle& triangle, Visit&& visit) const;

  std::array<double, 2> low_{}, high_{}, scale_{};
  std::array<std::uint32_t, 2> bits_{}, drop_{};   // columns are 2^bits; squares take 2^drop of them together
  std::vector<Triangle> triangles_;
  std::vector<std::uint32_t> first_, entries_;   // by square; numbers of triangles
};

}  // namespace palpate

#pragma once
#include <random>

#include "model/lattice/vector.h"

namespace palpate {

/// Lattice points for tests of predicates: far apart, on a tiny grid (where points, edges and planes
/// coincide), and at the lattice's end.
class LatticePoints {
 public:
  explicit LatticePoints(std::uint64_t seed) : engine_(seed) {}

  /// The next points come from: 0 the whole lattice, 1 a grid of 5³, 2 a grid of 5³ scaled to the lattice's
  /// ends, 3 within 1000.
  void choose() {
    kind_ = static_cast<int>(engine_() % 4);
    offset_ = kind_ == 1 ? Int3(within(1 << 27), within(1 << 27), within(1 << 27)) : Int3(0);
  }
  Int3 point() { return offset_ + Int3(coordinate(), coordinate(), coordinate()); }
  int within(int bound) { return std::uniform_int_distribution<int>(-bound, bound)(engine_); }
  /// A triangle with an area.
  void triangle(Int3 (&corner)[3]) {
    do
      for (Int3& c : corner) c = point();
    while (normal(corner) == Long3(0));
  }
  static Long3 normal(const Int3 (&c)[3]) {
    return cross(Long3(c[1]) - Long3(c[0]), Long3(c[2]) - Long3(c[0]));
  }
  static Long3 cross(const Long3& a, const Long3& b) {
    return {a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x};
  }

 private:
  int coordinate() {
    switch (kind_) {
      case 0:
        return within(1 << 28);
      case 1:
        return within(2);
      case 2:
        return within(2) * (1 << 27);
      default:
        return within(1000);
    }
  }
  std::mt19937_64 engine_;
  int kind_ = 0;
  Int3 offset_{0};
};

}  // namespace palpate

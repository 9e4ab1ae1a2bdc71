#pragma once

namespace palpate {

/// One tick of M ÿ + c ẏ + k y = g with g constant over the tick, solved exactly (a matrix exponential made
/// once): stable for every M > 0, c ≥ 0, k ≥ 0, whatever the tick. Works on any vector type V.
class MassSpring {
 public:
  MassSpring(double mass, double damping, double stiffness, double tick_s);

  template <class V>
  void step(V& y, V& velocity, const V& g) const {
    const V y_before = y;
    y = yy_ * y_before + yv_ * velocity + yg_ * g;
    velocity = vy_ * y_before + vv_ * velocity + vg_ * g;
  }

 private:
  double yy_, yv_, yg_, vy_, vv_, vg_;
};

}  // namespace palpate

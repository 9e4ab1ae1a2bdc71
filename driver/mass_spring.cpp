#include "driver/mass_spring.h"

#include <array>
#include <cmath>
#include <cstddef>

namespace palpate {
namespace {

using Matrix = std::array<std::array<double, 3>, 3>;

Matrix product(const Matrix& a, const Matrix& b) {
  Matrix out{};
  for (std::size_t r = 0; r < 3; ++r)
    for (std::size_t c = 0; c < 3; ++c)
      for (std::size_t i = 0; i < 3; ++i) out[r][c] += a[r][i] * b[i][c];
  return out;
}

/// e^A by its series on A / 2^s (entries below 1/2, so 20 terms reach double precision), squared s times.
Matrix exponential(Matrix a) {
  double largest = 0;
  for (const auto& row : a)
    largest = std::fmax(largest, std::abs(row[0]) + std::abs(row[1]) + std::abs(row[2]));
  int squarings = 0;
  for (; largest > 0.5; largest /= 2) ++squarings;
  const double scale = std::ldexp(1.0, -squarings);
  for (auto& row : a)
    for (double& entry : row) entry *= scale;

  const Matrix identity{{{1, 0, 0}, {0, 1, 0}, {0, 0, 1}}};
  Matrix sum = identity;
  for (int term = 20; term >= 1; --term) {  // Horner: I + A/1 (I + A/2 (I + …))
    sum = product(a, sum);
    for (std::size_t r = 0; r < 3; ++r)
      for (std::size_t c = 0; c < 3; ++c) sum[r][c] = identity[r][c] + sum[r][c] / term;
  }
  for (int i = 0; i < squarings; ++i) sum = product(sum, sum);
  return sum;
}

}  // namespace

MassSpring::MassSpring(double mass, double damping, double stiffness, double tick_s) {
  // State (y, ẏ, g); g does not change in a tick.
  const Matrix rates{
      {{0, tick_s, 0}, {-stiffness / mass * tick_s, -damping / mass * tick_s, tick_s / mass}, {0, 0, 0}}};
  const Matrix e = exponential(rates);
  yy_ = e[0][0], yv_ = e[0][1], yg_ = e[0][2];
  vy_ = e[1][0], vv_ = e[1][1], vg_ = e[1][2];
}

}  // namespace palpate

#include "model/mesh/smooth_angle.h"

#include <fmt/format.h>
#include <boost/multiprecision/cpp_int.hpp>
#include <cmath>

namespace palpate {
namespace {

using Wide = boost::multiprecision::int512_t;

// |n1·n2| < 2^122, its square times a denominator of 2^30 < 2^274: 512 bits hold everything.
bool smooth_exactly(const Long3& n1, const Long3& n2, const SmoothAngle& angle) {
  const Wide dot = Wide(n1.x) * n2.x + Wide(n1.y) * n2.y + Wide(n1.z) * n2.z;
  if (dot <= 0) return false;
  const Wide square1 = Wide(n1.x) * n1.x + Wide(n1.y) * n1.y + Wide(n1.z) * n1.z;
  const Wide square2 = Wide(n2.x) * n2.x + Wide(n2.y) * n2.y + Wide(n2.z) * n2.z;
  return dot * dot * angle.cos2_denominator > square1 * square2 * angle.cos2_numerator;
}

}  // namespace

Result<SmoothAngle> make_smooth_angle(double degrees) {
  if (!(degrees >= 0 && degrees <= 90))
    return bad_value(fmt::format("smooth_angle_deg is {}, it must lie between 0 and 90 degrees", degrees));
  if (degrees == 0) return SmoothAngle{1, 1};
  if (degrees == 30) return SmoothAngle{3, 4};
  if (degrees == 45) return SmoothAngle{1, 2};
  if (degrees == 60) return SmoothAngle{1, 4};
  if (degrees == 90) return SmoothAngle{0, 1};
  constexpr double kRadian = 0.017453292519943295;  // π/180
  const double cosine = std::cos(degrees * kRadian);
  return SmoothAngle{std::llround(cosine * cosine * 0x1p30), std::int64_t{1} << 30};
}

bool smooth(const Long3& n1, const Long3& n2, const SmoothAngle& angle) {
  // The filter: with u = 2^-53, rounding the components, products and sums puts `dot` off by less than 6 u
  // |n1||n2|, the squares by less than 6 u of themselves; so both sides of the comparison are off by less
  // than 20 u · |n1|²|n2|² · denominator in all (numerator ≤ denominator). 2^-47 = 64 u is above that: beyond
  // it, doubles decide.
  const glm::dvec3 a(n1), b(n2);
  const double dot = a.x * b.x + a.y * b.y + a.z * b.z;
  const double squares = (a.x * a.x + a.y * a.y + a.z * a.z) * (b.x * b.x + b.y * b.y + b.z * b.z);
  const double difference = dot * dot * static_cast<double>(angle.cos2_denominator) -
                            squares * static_cast<double>(angle.cos2_numerator);
  const double doubt = 0x1p-47 * squares * static_cast<double>(angle.cos2_denominator);
  if (difference < -doubt) return false;
  if (difference > doubt) return dot > 0;  // dot² > 2^-47 |n1|²|n2|² here, so its sign is certain
  return smooth_exactly(n1, n2, angle);
}

}  // namespace palpate

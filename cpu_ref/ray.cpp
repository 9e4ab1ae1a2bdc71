#include "cpu_ref/ray.h"

namespace palpate::cpu_ref {

int first_sign(const Long3& v) {
  for (int k = 0; k < 3; ++k)
    if (v[k] != 0) return v[k] > 0 ? 1 : -1;
  return 0;
}

int line_passes(const Int3& p, const Int3& direction, const Triangle& triangle) {
  const Long3 d(direction);
  const int facing = sign(dot(d, triangle.normal));
  if (facing == 0) return 0;
  for (int k = 0; k < 3; ++k) {
    const Int3 &from = triangle[k], &to = triangle[(k + 1) % 3];
    // D·((u − p) × (v − p)): within 2^29 · 2^59.2 · 3. Its derivative by p is D × (v − u), which the ε's pick
    // apart.
    int side = sign(dot(d, cross(difference(from, p), difference(to, p))));
    if (side == 0) side = first_sign(cross(d, difference(to, from)));
    if (side != facing) return 0;
  }
  return facing;
}

namespace {

/// t · (D·N) of the crossing with the plane, and whether the perturbed point is before it.
bool is_ahead(Int128 to_plane, int facing, const Triangle& triangle) {
  const int side = to_plane != 0 ? sign(to_plane) : -first_sign(triangle.normal);
  return side == facing;
}

}  // namespace

std::optional<Crossing> ray_crosses(const Int3& p, const Int3& direction, const Triangle& triangle) {
  const int facing = line_passes(p, direction, triangle);
  if (facing == 0 || !is_ahead(-triangle.side(p), facing, triangle)) return std::nullopt;
  return Crossing{facing, 0};
}

std::optional<Crossing> ray_crosses_at(const Int3& p, const Int3& direction, const Triangle& triangle) {
  const int facing = line_passes(p, direction, triangle);
  const Int128 to_plane = -triangle.side(p);
  if (facing == 0 || !is_ahead(to_plane, facing, triangle)) return std::nullopt;
  // Both have the sign `facing` (or the first is 0). Numerator within 2^90 · 2^30.
  const Int128 numerator = to_plane * facing * (Int128{1} << 30);
  const Int128 denominator = dot(Long3(direction), triangle.normal) * facing;
  return Crossing{facing, static_cast<std::uint32_t>(numerator / denominator)};
}

}  // namespace palpate::cpu_ref

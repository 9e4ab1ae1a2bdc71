#include "cpu_ref/samples.h"

namespace palpate::cpu_ref {

bool projection_holds(const Triangle& triangle, int axis, std::int64_t g_u, std::int64_t g_v) {
  const int u = (axis + 1) % 3, v = (axis + 2) % 3;
  const int facing = triangle.normal[axis] > 0 ? 1 : -1;
  for (int k = 0; k < 3; ++k) {
    const Int3 &p = triangle[k], &q = triangle[(k + 1) % 3];
    const std::int64_t along_u = std::int64_t{q[u]} - p[u], along_v = std::int64_t{q[v]} - p[v];
    const std::int64_t area = along_u * (g_v - p[v]) - along_v * (g_u - p[u]);   // within 2^59
    int side = (area > 0) - (area < 0);
    if (side == 0) side = along_v != 0 ? (along_v < 0 ? 1 : -1) : along_u > 0 ? 1 : -1;
    if (side != facing) return false;
  }
  return true;
}

Int3 raised(const Triangle& triangle, int axis, std::int64_t g_u, std::int64_t g_v) {
  const int u = (axis + 1) % 3, v = (axis + 2) % 3;
  const Int3& a = triangle[0];
  const Int128 slope = Int128{triangle.normal[u]} * (g_u - a[u]) + Int128{triangle.normal[v]} * (g_v - a[v]);
  const std::int64_t n = triangle.normal[axis];
  // floor(a − slope / n) with a positive divisor.
  const Int128 rise = n > 0 ? floor_divide(-slope, Int128{n}) : floor_divide(slope, -Int128{n});
  Int3 point;
  point[u] = static_cast<std::int32_t>(g_u);
  point[v] = static_cast<std::int32_t>(g_v);
  point[axis] = a[axis] + static_cast<std::int32_t>(rise);
  return point;
}

}  // namespace palpate::cpu_ref

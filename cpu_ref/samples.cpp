#include "cpu_ref/samples.h"

namespace palpate::cpu_ref {

std::int64_t golden_part(std::int64_t n) {
  constexpr std::int64_t kWhole = std::int64_t{1} << 32,
                         kRatio = 2654435769;  // (√5 − 1) / 2, which has the same fractional parts
  const std::int64_t within = n - floor_divide(n, kWhole) * kWhole;
  return static_cast<std::int64_t>(Int128{within} * kRatio % kWhole);
}

Cell sample_of(const Cell& cell, std::int32_t spacing) {
  const auto moved = [&](std::int64_t n) {
    return floor_divide(golden_part(n) * spacing, std::int64_t{1} << 32);
  };
  return {cell.i * spacing + moved(cell.j), cell.j * spacing + moved(cell.i)};
}

int level_of(Cell cell) {
  for (int level = 0; level < kSampleLevels; level += 2) {
    const Cell block{floor_divide(cell.i, std::int64_t{2}), floor_divide(cell.j, std::int64_t{2})};
    // Where a sample of the block as one cell would be, the one that stands for the block is.
    const Cell stands{2 * block.i + floor_divide(2 * golden_part(block.j), std::int64_t{1} << 32),
                      2 * block.j + floor_divide(2 * golden_part(block.i), std::int64_t{1} << 32)};
    const Cell opposite{4 * block.i + 1 - stands.i, 4 * block.j + 1 - stands.j};
    if (cell == opposite) return level + 1;
    if (cell != stands) return level;
    cell = block;
  }
  return kSampleLevels;
}

bool projection_holds(const Triangle& triangle, int axis, std::int64_t g_u, std::int64_t g_v) {
  const int u = (axis + 1) % 3, v = (axis + 2) % 3;
  const int facing = triangle.normal[axis] > 0 ? 1 : -1;
  for (int k = 0; k < 3; ++k) {
    const Int3 &p = triangle[k], &q = triangle[(k + 1) % 3];
    const std::int64_t along_u = std::int64_t{q[u]} - p[u], along_v = std::int64_t{q[v]} - p[v];
    const std::int64_t area = along_u * (g_v - p[v]) - along_v * (g_u - p[u]);  // within 2^59
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

// Whether a ray may meet a box or a triangle: cheap, in single precision, with a margin, so that it may cull
// for exact tests.
// A perturbed ray that crosses a triangle meets it, closed, unperturbed.
#ifndef PALPATE_LIB_LINE_BOX
#define PALPATE_LIB_LINE_BOX

// What rounding may add up to. With |e| < 1 and differences within 2^30 (doubled ones for boxes), each
// product of a rounded e, a rounded difference and its own rounding is off by at most 3 · 2^30 · 2^-24 = 192,
// a sum of two of them by 512, with the extents'
// 256, and three of them by 700, with 350: below the margin. Fused multiply-adds only round less.
const float kRayMargin = 2048.0;

// A direction for the tests below: |d_i| < 2^29.
vec3 ray_scaled(ivec3 d) { return vec3(d) * (1.0 / 536870912.0); }

// Box [low, high], p and the box within 2^28. An empty box (low > high) is not met.
bool ray_may_meet_box(ivec3 p, vec3 e, ivec3 low, ivec3 high) {
  if (low.x > high.x) return false;
  const vec3 c = vec3(low + high - 2 * p), h = vec3(high - low), f = abs(e);
  const vec3 away = abs(e.yzx * c.zxy - e.zxy * c.yzx), reach = f.yzx * h.zxy + f.zxy * h.yzx;
  return all(lessThanEqual(away, reach + kRayMargin)) &&
         e.x * c.x + e.y * c.y + e.z * c.z + f.x * h.x + f.y * h.y + f.z * h.z >= -kRayMargin;
}

// Triangle abc: seen along the ray and dropped on each of the coordinate planes, its box must hold the ray.
bool ray_may_meet_triangle(ivec3 p, vec3 e, ivec3 a, ivec3 b, ivec3 c) {
  const vec3 u = vec3(a - p), v = vec3(b - p), w = vec3(c - p);
  const vec3 s = e.yzx * u.zxy - e.zxy * u.yzx, t = e.yzx * v.zxy - e.zxy * v.yzx,
             r = e.yzx * w.zxy - e.zxy * w.yzx;
  return all(lessThanEqual(min(min(s, t), r), vec3(kRayMargin))) &&
         all(greaterThanEqual(max(max(s, t), r), vec3(-kRayMargin)));
}
#endif

// Whether a segment crosses a triangle (lib/segment.glsl), in single precision where that is sure.
#ifndef PALPATE_LIB_SEGMENT_ESTIMATE
#define PALPATE_LIB_SEGMENT_ESTIMATE

const int32_t kUnsure = 2;

// What segment_crossing(p, q, a, b, c) says, or kUnsure. Five signs say it: on which side of the edges the way
// passes, whether p lies before the plane and q behind it. All alike it crosses, two unlike it does not.
// docs/EXACTNESS.md section 9 has the slack.
int32_t segment_estimate(ivec3 p, ivec3 q, ivec3 a, ivec3 b, ivec3 c) {
  const vec3 u = vec3(a - p), v = vec3(b - p), w = vec3(c - p), d = vec3(q - p);
  const vec3 uv = u.yzx * v.zxy - u.zxy * v.yzx, vw = v.yzx * w.zxy - v.zxy * w.yzx,
             wu = w.yzx * u.zxy - w.zxy * u.yzx;
  const vec3 sides = vec3(d.x * uv.x + d.y * uv.y + d.z * uv.z, d.x * vw.x + d.y * vw.y + d.z * vw.z,
                          d.x * wu.x + d.y * wu.y + d.z * wu.z);
  const float before = u.x * vw.x + u.y * vw.y + u.z * vw.z, behind = sides.x + sides.y + sides.z - before;
  const vec3 most = max(max(abs(u), abs(v)), abs(w)), along = abs(d);
  const float size = max(max(most.x, most.y), most.z), way = max(max(along.x, along.y), along.z);
  const float unit = size * size * (1.0 / 262144.0);   // 64 · 2^-24
  const float side = unit * way, end = unit * (size + 3.0 * way);
  const float least_side = min(min(sides.x, sides.y), sides.z), most_side = max(max(sides.x, sides.y), sides.z),
              least_end = min(before, behind), most_end = max(before, behind);
  const bool some_above = most_side > side || most_end > end, some_below = least_side < -side || least_end < -end;
  if (some_above && some_below) return 0;
  if (least_side > side && least_end > end) return 1;
  return most_side < -side && most_end < -end ? -1 : kUnsure;
}
#endif

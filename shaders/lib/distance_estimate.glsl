// Between what bounds a triangle's distance lies, in single precision.
#ifndef PALPATE_LIB_DISTANCE_ESTIMATE
#define PALPATE_LIB_DISTANCE_ESTIMATE
#include "shaders/shared/frame_field.h"

struct DistanceBounds {
  float least, most;   // another triangle whose `least` is beyond `most` is not the nearest
  bool above;          // no edge has the point on its outer side: the distance is the height above the plane
};

// Squared distance, beside the height, to the edge e from its first end's f on; `side`: how far the point lies
// on the edge's outer side. m: the normal.
float edge_estimate(vec3 e, vec3 f, vec3 m, out float side) {
  const float squared = e.x * e.x + e.y * e.y + e.z * e.z, one = inversesqrt(squared);
  const vec3 across = e.yzx * m.zxy - e.zxy * m.yzx;
  side = (across.x * f.x + across.y * f.y + across.z * f.z) * one;
  const float at = (e.x * f.x + e.y * f.y + e.z * f.z) * one, over = max(0.0, max(-at, at - squared * one));
  return side * side + over * over;
}

float reach_of(vec3 f) { return abs(f.x) + abs(f.y) + abs(f.z); }

// Of p from abc with the unit normal n, not collapsed. docs/EXACTNESS.md section 9 has the slack.
DistanceBounds distance_bounds(ivec3 a, ivec3 b, ivec3 c, ivec3 n, ivec3 p) {
  const vec3 f = vec3(p - a), g = vec3(p - b), h = vec3(p - c), m = vec3(n) * (1.0 / 1073741824.0);
  vec3 sides;
  const float ab = edge_estimate(vec3(b - a), f, m, sides.x), bc = edge_estimate(vec3(c - b), g, m, sides.y),
              ca = edge_estimate(vec3(a - c), h, m, sides.z);
  const float slack = (reach_of(f) + reach_of(g) + reach_of(h)) * (1.0 / 32768.0);
  const float height = m.x * f.x + m.y * f.y + m.z * f.z;
  const bool within = max(max(sides.x, sides.y), sides.z) < -slack;
  const float away = sqrt(height * height + (within ? 0.0 : min(min(ab, bc), ca)));
  return DistanceBounds(away - slack, away + slack + float(2 * kDepthSlack), within);
}
#endif

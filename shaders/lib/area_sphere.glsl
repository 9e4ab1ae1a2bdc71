// The sphere of an area (docs/EXACTNESS.md section 5): whether it holds a tool triangle, and how far off a
// triangle is. The including shader declares areas[].
#ifndef PALPATE_LIB_AREA_SPHERE
#define PALPATE_LIB_AREA_SPHERE

int64_t squared(ivec3 v) {
  const i64vec3 w = i64vec3(v);
  return w.x * w.x + w.y * w.y + w.z * w.z;
}

// |2g − c2|² for the rounded centroid g of a triangle; components within 2^30: below 2^62.
int64_t area_distance(uint32_t area, ivec3 g) {
  return squared(2 * g - (areas[area].box_low + areas[area].box_high));
}

bool area_holds(uint32_t area, ivec3 g) {
  return area_distance(area, g) <= squared(areas[area].box_high - areas[area].box_low);
}
#endif

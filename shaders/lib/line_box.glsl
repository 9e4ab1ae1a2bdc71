// Whether the ray from p in direction d may meet a closed box: exact but for the far ends of edges, and never wrong the
// other way. A perturbed ray that crosses a triangle touches its closed box unperturbed, so that this may cull.
#ifndef PALPATE_LIB_LINE_BOX
#define PALPATE_LIB_LINE_BOX
// |d_i| < 2^29; box and p within 2^28, so that doubled differences are within 2^30: products within 2^59, sums within 2^61.
bool ray_may_meet(ivec3 p, ivec3 d, ivec3 low, ivec3 high) {
  const i64vec3 c = i64vec3(low + high - 2 * p);
  const i64vec3 h = i64vec3(high - low);
  const i64vec3 e = i64vec3(d), f = i64vec3(abs(d));
  if (low.x > high.x) return false;   // an empty box
  if (abs(e.x * c.y - e.y * c.x) > f.x * h.y + f.y * h.x) return false;
  if (abs(e.y * c.z - e.z * c.y) > f.y * h.z + f.z * h.y) return false;
  if (abs(e.z * c.x - e.x * c.z) > f.z * h.x + f.x * h.z) return false;
  return e.x * c.x + e.y * c.y + e.z * c.z + f.x * h.x + f.y * h.y + f.z * h.z >= 0l;   // not wholly behind p
}
#endif

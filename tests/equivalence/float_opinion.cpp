#include "tests/equivalence/float_opinion.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <vector>

#include "cpu_ref/triangle_triangle.h"

namespace palpate::equivalence {
namespace {

using cpu_ref::Box;
using cpu_ref::Triangle;

struct Float3 {
  float x, y, z;
};
Float3 operator-(const Float3& a, const Float3& b) { return {a.x - b.x, a.y - b.y, a.z - b.z}; }
float dot(const Float3& a, const Float3& b) { return a.x * b.x + a.y * b.y + a.z * b.z; }
Float3 cross(const Float3& a, const Float3& b) {
  return {a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x};
}
Float3 size(const Float3& a) { return {std::fabs(a.x), std::fabs(a.y), std::fabs(a.z)}; }

using FloatTriangle = std::array<Float3, 3>;

/// A lattice point in floats, as a program that never left metres would have it but for a power of two.
FloatTriangle in_floats(const Triangle& t) {
  FloatTriangle out;
  for (int k = 0; k < 3; ++k)
    out[static_cast<std::size_t>(k)] = {static_cast<float>(t[k].x), static_cast<float>(t[k].y),
                                        static_cast<float>(t[k].z)};
  return out;
}

/// (b − a) · ((c − a) × (d − a)) in single precision, and a bound on the error made: coordinates were rounded
/// (2^-24 each), and some seven roundings follow; 16 · 2^-24 of the determinant's permanent, plus the
/// coordinates' share, covers both.
struct Side {
  float value;
  bool certain;
};
Side side(const Float3& a, const Float3& b, const Float3& c, const Float3& d) {
  const Float3 u = b - a, v = c - a, w = d - a;
  const float value = dot(u, cross(v, w));
  const Float3 p = size(u), q = size(v), r = size(w);
  const float permanent =
      p.x * (q.y * r.z + q.z * r.y) + p.y * (q.z * r.x + q.x * r.z) + p.z * (q.x * r.y + q.y * r.x);
  const auto largest = [](const Float3& e) {
    return std::max({std::fabs(e.x), std::fabs(e.y), std::fabs(e.z)});
  };
  const float coordinate = std::max(std::max(largest(a), largest(b)), std::max(largest(c), largest(d)));
  const float edge = std::max(largest(p), std::max(largest(q), largest(r)));
  const float error = 0x1p-24f * (16 * permanent + 36 * coordinate * edge * edge);
  return {value, std::fabs(value) > error};
}

int sign(float v) { return (v > 0) - (v < 0); }

/// Edge pq against triangle t by five signs, as is usual; coplanar edges are taken as missing.
bool edge_meets(const Float3& p, const Float3& q, const FloatTriangle& t) {
  const int sp = sign(side(t[0], t[1], t[2], p).value), sq = sign(side(t[0], t[1], t[2], q).value);
  if (sp * sq > 0 || (sp == 0 && sq == 0)) return false;
  const int s0 = sign(side(p, q, t[0], t[1]).value), s1 = sign(side(p, q, t[1], t[2]).value),
            s2 = sign(side(p, q, t[2], t[0]).value);
  return (s0 >= 0 && s1 >= 0 && s2 >= 0) || (s0 <= 0 && s1 <= 0 && s2 <= 0);
}

bool meet_in_floats(const FloatTriangle& s, const FloatTriangle& t) {
  for (std::size_t k = 0; k < 3; ++k)
    if (edge_meets(s[k], s[(k + 1) % 3], t) || edge_meets(t[k], t[(k + 1) % 3], s)) return true;
  return false;
}

bool certain(const FloatTriangle& s, const FloatTriangle& t) {
  for (std::size_t k = 0; k < 3; ++k)
    if (!side(s[0], s[1], s[2], t[k]).certain || !side(t[0], t[1], t[2], s[k]).certain) return false;
  return true;
}

}  // namespace

void judge_in_floats(const SceneGeometry& geometry, const LatticePose& pose, const Contacts& contacts,
                     FloatOpinion& into) {
  std::vector<Triangle> statics, mobiles;
  for (const auto* set : {&contacts.cst, &contacts.bst})
    for (const std::uint32_t id : *set) statics.push_back(cpu_ref::triangle_of(geometry.mockup, id));
  for (const auto* set : {&contacts.cmt, &contacts.bmt})
    for (const std::uint32_t id : *set) {
      const Triangle t = cpu_ref::triangle_of(geometry.tool, id);
      mobiles.emplace_back(transform(pose, t[0]), transform(pose, t[1]), transform(pose, t[2]));
    }
  std::vector<Box> boxes;
  for (const Triangle& m : mobiles) boxes.push_back(m.box());
  std::uint64_t ambiguous = 0, wrong = 0;
  for (const Triangle& s : statics) {
    const Box box = s.box();
    const FloatTriangle float_s = in_floats(s);
    for (std::size_t m = 0; m < mobiles.size(); ++m) {
      if (!box.meets(boxes[m]) || mobiles[m].collapsed()) continue;
      ++into.pairs;
      const FloatTriangle float_m = in_floats(mobiles[m]);
      ambiguous += certain(float_s, float_m) ? 0u : 1u;
      wrong += meet_in_floats(float_s, float_m) == cpu_ref::triangles_intersect(s, mobiles[m]) ? 0u : 1u;
    }
  }
  into.ambiguous += ambiguous;
  into.wrong += wrong;
  into.ambiguous_poses += ambiguous > 0 ? 1u : 0u;
  into.wrong_poses += wrong > 0 ? 1u : 0u;
}

}  // namespace palpate::equivalence

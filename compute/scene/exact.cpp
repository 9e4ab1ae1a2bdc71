#include "compute/scene/exact.h"

#include <algorithm>
#include <bit>
#include <cstdlib>

namespace palpate::exact {
namespace {

/// Sign of the first component that is not 0.
int first_sign(const Normal& n) { return n.x != 0 ? sign(n.x) : n.y != 0 ? sign(n.y) : sign(n.z); }

/// Sides of t's corners of the plane through p with normal n.
std::array<int, 3> plane_sides(const Normal& n, const Int3& p, const Corners& t) {
  return {sign(dot(n, t[0] - p)), sign(dot(n, t[1] - p)), sign(dot(n, t[2] - p))};
}

bool one_sided(const std::array<int, 3>& s) {
  return (s[0] > 0 && s[1] > 0 && s[2] > 0) || (s[0] < 0 && s[1] < 0 && s[2] < 0);
}
bool same_side(const std::array<int, 3>& s) {
  return (s[0] >= 0 && s[1] >= 0 && s[2] >= 0) || (s[0] <= 0 && s[1] <= 0 && s[2] <= 0);
}

/// Doubled signed area of uvw seen along axis k; within 2^60.
std::int64_t area_along(int k, const Int3& u, const Int3& v, const Int3& w) {
  const int i = (k + 1) % 3, j = (k + 2) % 3;
  return std::int64_t{v[i] - u[i]} * (w[j] - u[j]) - std::int64_t{v[j] - u[j]} * (w[i] - u[i]);
}

/// Whether an edge of s has all of t strictly on its outer side, seen along k.
bool edge_separates(const Corners& s, const Corners& t, int k) {
  const int turn = sign(area_along(k, s[0], s[1], s[2]));
  for (std::size_t e = 0; e < 3; ++e) {
    const Int3 &u = s[e], &v = s[(e + 1) % 3];
    if (std::all_of(t.begin(), t.end(),
                    [&](const Int3& w) { return turn * sign(area_along(k, u, v, w)) < 0; }))
      return true;
  }
  return false;
}

/// Convex sets in a plane are disjoint exactly when a line along an edge of one of them separates them
/// strictly.
bool coplanar_meet(const Corners& s, const Corners& t, const Normal& n) {
  const std::int64_t x = std::abs(n.x), y = std::abs(n.y), z = std::abs(n.z);
  const int k = z > std::max(x, y) ? 2 : y > x ? 1 : 0;
  return !edge_separates(s, t, k) && !edge_separates(t, s, k);
}

/// Side on which the perturbed line from p along d passes the edge from u to v.
int edge_side(const Int3& p, const Int3& d, const Int3& u, const Int3& v) {
  const int side = sign(dot(raw_normal(p, u, v), d));
  return side != 0 ? side : first_sign(cross(d, v - u));
}

/// One of the nine axes (unit vector × edge): s and t are the projections of the edge and of the third
/// corner.
bool parted(std::int64_t s, std::int64_t t, std::int64_t radius) {
  return std::min(s, t) > radius || std::max(s, t) < -radius;
}

/// The three axes of edge f, from corner p (an end of f) and corner q (the one opposite), relative to the
/// cube's centre and doubled like its side e.
bool edge_parts(const Int3& f, const Int3& p, const Int3& q, std::int64_t e) {
  const Normal of_p = cross(p, f), of_q = cross(q, f);
  const std::int64_t x = std::abs(f.x), y = std::abs(f.y), z = std::abs(f.z);
  return parted(of_p.x, of_q.x, e * (y + z)) || parted(of_p.y, of_q.y, e * (z + x)) ||
         parted(of_p.z, of_q.z, e * (x + y));
}

}  // namespace

bool triangles_meet(const Corners& s, const Corners& t, const Normal& t_normal) {
  const std::array<int, 3> s_sides = plane_sides(t_normal, t[0], s);
  if (one_sided(s_sides)) return false;
  const std::array<int, 3> t_sides = plane_sides(raw_normal(s), s[0], t);
  if (one_sided(t_sides)) return false;
  if (s_sides == std::array<int, 3>{}) return coplanar_meet(s, t, t_normal);

  // In different planes they meet exactly when an edge of one, its ends on different sides of the other's
  // plane (touching allowed, not both), passes the other's three edges on one side. lines[i][j]: how edge i
  // of s passes edge j of t; the same number the other way round.
  std::array<std::array<int, 3>, 3> lines;
  for (std::size_t i = 0; i < 3; ++i) {
    const Int3 &p = s[i], &q = s[(i + 1) % 3];
    for (std::size_t j = 0; j < 3; ++j) lines[i][j] = sign(dot(raw_normal(p, q, t[j]), t[(j + 1) % 3] - p));
    const int from = s_sides[i], to = s_sides[(i + 1) % 3];
    if (from * to <= 0 && (from != 0 || to != 0) && same_side(lines[i])) return true;
  }
  for (std::size_t j = 0; j < 3; ++j) {
    const int from = t_sides[j], to = t_sides[(j + 1) % 3];
    if (from * to <= 0 && (from != 0 || to != 0) && same_side({lines[0][j], lines[1][j], lines[2][j]}))
      return true;
  }
  return false;
}

bool triangle_touches_cube(const Corners& t, const Box& box, const Int3& low, std::int32_t side) {
  const Int3 high = low + side;
  int beyond = 0;  // axes along which the triangle's box leaves the cube
  for (int k = 0; k < 3; ++k) {
    if (box.low[k] > high[k] || box.high[k] < low[k]) return false;
    beyond += box.low[k] < low[k] || box.high[k] > high[k] ? 1 : 0;
  }
  // Along one axis it has a point within the cube's reach, like every connected set with such a box, and
  // along the others all of it is.
  if (beyond <= 1) return true;
  for (const Int3& corner : t)
    if (corner == glm::clamp(corner, low, high)) return true;

  const Normal normal = raw_normal(t);
  const Int3 centre = 2 * low + side;
  const Int3 p = 2 * t[0] - centre, q = 2 * t[1] - centre, r = 2 * t[2] - centre;
  // The triangle's plane: |n·p| ≤ |n|·e.
  const Wide distance = dot(normal, p),
             reach = Wide{side} * (Wide{std::abs(normal.x)} + std::abs(normal.y) + std::abs(normal.z));
  if (distance > reach || -distance > reach) return false;
  return !edge_parts(t[1] - t[0], p, r, side) && !edge_parts(t[2] - t[1], q, p, side) &&
         !edge_parts(t[0] - t[2], r, q, side);
}

int plane_ahead(const Normal& n, const Int3& p, const Int3& a) {
  const int side = sign(dot(n, a - p));
  return side != 0 ? side : -first_sign(n);
}

int segment_crossing(const Int3& p, const Int3& q, const Corners& t) {
  const Normal n = raw_normal(t);
  if (n == Normal{}) return 0;
  const int facing = plane_ahead(n, p, t[0]);
  if (plane_ahead(n, q, t[0]) == facing) return 0;  // both ends on one side
  const Int3 d = q - p;
  return edge_side(p, d, t[0], t[1]) == facing && edge_side(p, d, t[1], t[2]) == facing &&
                 edge_side(p, d, t[2], t[0]) == facing
             ? facing
             : 0;
}

int grid_side(std::int64_t pu, std::int64_t pv, std::int64_t qu, std::int64_t qv, std::int64_t u,
              std::int64_t v) {
  const std::int64_t side = (qu - pu) * (v - pv) - (qv - pv) * (u - pu);
  if (side != 0) return side < 0 ? -1 : 1;
  if (qv != pv) return pv > qv ? 1 : -1;
  return qu > pu ? 1 : qu < pu ? -1 : 0;
}

Int3 normalise(const Normal& sum) {
  const std::int64_t parts[3] = {sum.x, sum.y, sum.z};
  const std::int64_t largest = std::max({std::abs(sum.x), std::abs(sum.y), std::abs(sum.z)});
  const int k = 28 - (63 - std::countl_zero(static_cast<std::uint64_t>(largest)));
  Int3 out;
  for (int i = 0; i < 3; ++i) {
    const std::int64_t size = k >= 0 ? std::abs(parts[i]) << k : std::abs(parts[i]) >> -k;
    out[i] = static_cast<std::int32_t>(parts[i] < 0 ? -size : size);
  }
  return out;
}

}  // namespace palpate::exact

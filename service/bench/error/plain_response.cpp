#include "service/bench/error/plain_response.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <vector>

#include "service/cli/console.h"

namespace palpate {
namespace {

template <class Real>
using V = std::array<Real, 3>;

template <class Real>
V<Real> operator_minus(const V<Real>& a, const V<Real>& b) {
  return {a[0] - b[0], a[1] - b[1], a[2] - b[2]};
}
template <class Real>
V<Real> cross(const V<Real>& a, const V<Real>& b) {
  return {a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]};
}
template <class Real>
Real dot(const V<Real>& a, const V<Real>& b) {
  return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}

template <class Real>
struct Body {
  std::vector<std::array<V<Real>, 3>> triangles;
};

template <class Real>
V<Real> cast(const Vec3& v) {
  return {static_cast<Real>(v.x), static_cast<Real>(v.y), static_cast<Real>(v.z)};
}

template <class Real>
Body<Real> body_of(const Mesh& mesh) {
  Body<Real> out;
  for (const auto& t : mesh.triangles)
    out.triangles.push_back(
        {cast<Real>(mesh.vertices[t[0]]), cast<Real>(mesh.vertices[t[1]]), cast<Real>(mesh.vertices[t[2]])});
  return out;
}

/// Rotation matrix times vertex plus position, all in Real.
template <class Real>
Body<Real> moved(Body<Real> body, const Pose& pose) {
  const Quat& q = pose.rotation;
  const auto x = static_cast<Real>(q.x), y = static_cast<Real>(q.y), z = static_cast<Real>(q.z),
             w = static_cast<Real>(q.w);
  const Real one(1), two(2);
  const V<Real> rows[3] = {{one - two * (y * y + z * z), two * (x * y - z * w), two * (x * z + y * w)},
                           {two * (x * y + z * w), one - two * (x * x + z * z), two * (y * z - x * w)},
                           {two * (x * z - y * w), two * (y * z + x * w), one - two * (x * x + y * y)}};
  const V<Real> p = cast<Real>(pose.position);
  for (auto& triangle : body.triangles)
    for (auto& v : triangle) {
      const V<Real> old = v;
      for (std::size_t r = 0; r < 3; ++r) v[r] = dot(rows[r], old) + p[r];
    }
  return body;
}

/// How often the ray from `from` along `way` leaves a body more often than it enters it.
template <class Real>
int winding(const Body<Real>& body, const V<Real>& from, const V<Real>& way) {
  int out = 0;
  for (const auto& t : body.triangles) {  // Möller and Trumbore
    const V<Real> e1 = operator_minus(t[1], t[0]), e2 = operator_minus(t[2], t[0]), h = cross(way, e2);
    const Real a = dot(e1, h);
    if (a == Real(0)) continue;
    const Real f = Real(1) / a;
    const V<Real> s = operator_minus(from, t[0]);
    const Real u = f * dot(s, h);
    if (u < Real(0) || u >= Real(1)) continue;
    const V<Real> q = cross(s, e1);
    const Real v = f * dot(way, q);
    if (v < Real(0) || u + v >= Real(1)) continue;
    if (f * dot(e2, q) < Real(0)) continue;
    out += a > Real(0) ? -1 : 1;
  }
  return out;
}

/// Distance of a point to a triangle: to its plane where it stands over it, else to the nearest edge.
template <class Real>
Real distance(const std::array<V<Real>, 3>& t, const V<Real>& p) {
  const V<Real> n = cross(operator_minus(t[1], t[0]), operator_minus(t[2], t[0]));
  const Real size = std::sqrt(dot(n, n));
  if (!(size > Real(0))) return HUGE_VALF;
  bool over = true;
  Real least(HUGE_VALF);
  for (std::size_t k = 0; k < 3; ++k) {
    const V<Real> edge = operator_minus(t[(k + 1) % 3], t[k]), from = operator_minus(p, t[k]);
    if (dot(cross(edge, from), n) < Real(0)) over = false;
    const Real along = std::clamp(dot(edge, from) / dot(edge, edge), Real(0), Real(1));
    const V<Real> off{from[0] - along * edge[0], from[1] - along * edge[1], from[2] - along * edge[2]};
    least = std::min(least, std::sqrt(dot(off, off)));
  }
  return over ? std::fabs(dot(n, operator_minus(p, t[0]))) / size : least;
}

/// Σ w φ n over the samples of `of` that lie inside `in`, and Σ w φ, Σ w.
template <class Real>
struct Sums {
  V<Real> push{Real(0), Real(0), Real(0)};
  Real depth{0}, weight{0};
};
template <class Real>
Sums<Real> sum_samples(const Body<Real>& of, const Body<Real>& in, Real spacing) {
  Sums<Real> out;
  V<Real> low = in.triangles.front()[0], high = low;
  for (const auto& t : in.triangles)
    for (const auto& v : t)
      for (std::size_t k = 0; k < 3; ++k) low[k] = std::min(low[k], v[k]), high[k] = std::max(high[k], v[k]);
  // A direction that no face of a simple body has, for the question of inside.
  const V<Real> askew{Real(0.36823), Real(0.48113), Real(0.79559)};
  for (const auto& t : of.triangles) {
    const V<Real> n = cross(operator_minus(t[1], t[0]), operator_minus(t[2], t[0]));
    std::size_t axis = 0;
    for (std::size_t k = 1; k < 3; ++k)
      if (std::fabs(n[k]) > std::fabs(n[axis])) axis = k;
    const std::size_t iu = (axis + 1) % 3, iv = (axis + 2) % 3;
    const Real size = std::sqrt(dot(n, n));
    if (!(size > Real(0))) continue;
    const auto range = [&](std::size_t i, Real& from, Real& to) {
      from = std::min({t[0][i], t[1][i], t[2][i]}), to = std::max({t[0][i], t[1][i], t[2][i]});
      from = std::floor(std::max(from, low[i]) / spacing),
      to = std::floor(std::min(to, high[i]) / spacing) + Real(1);
    };
    Real u0, u1, v0, v1;
    range(iu, u0, u1);
    range(iv, v0, v1);
    // A grid whose numbers can't be told apart has no points worth counting; nor has one of billions.
    if (!(u1 - u0 < Real(4096)) || !(v1 - v0 < Real(4096))) continue;
    const auto side = [&](const V<Real>& a, const V<Real>& b, Real u, Real v) {
      return (b[iu] - a[iu]) * (v - a[iv]) - (b[iv] - a[iv]) * (u - a[iu]);
    };
    const int nu = static_cast<int>(u1 - u0), nv = static_cast<int>(v1 - v0);
    const Real facing = n[axis] > Real(0) ? Real(1) : Real(-1);
    for (int j = 0; j <= nv && !interrupted(); ++j)
      for (int i = 0; i <= nu; ++i) {
        const Real u = (u0 + static_cast<Real>(i)) * spacing, v = (v0 + static_cast<Real>(j)) * spacing;
        if (side(t[0], t[1], u, v) * facing < Real(0) || side(t[1], t[2], u, v) * facing <= Real(0) ||
            side(t[2], t[0], u, v) * facing < Real(0))
          continue;
        V<Real> p;
        p[iu] = u, p[iv] = v;
        p[axis] = t[0][axis] - (n[iu] * (u - t[0][iu]) + n[iv] * (v - t[0][iv])) / n[axis];
        if (winding(in, p, askew) == 0) continue;
        Real depth(HUGE_VALF);
        for (const auto& other : in.triangles) depth = std::min(depth, distance(other, p));
        const Real weight = spacing * spacing * (size / std::fabs(n[axis]));
        out.depth += weight * depth;
        out.weight += weight;
        for (std::size_t k = 0; k < 3; ++k) out.push[k] += weight * depth * (n[k] / size);
      }
  }
  return out;
}

}  // namespace

template <class Real>
PlainAnswer plain_response(const Mesh& mockup, const Mesh& tool_mesh, const Pose& pose, double spacing_m,
                           double stiffness_n_per_m, double reference_area_m2) {
  const Body<Real> statics = body_of<Real>(mockup), tool = moved(body_of<Real>(tool_mesh), pose);
  const auto spacing = static_cast<Real>(spacing_m), area = static_cast<Real>(reference_area_m2),
             stiffness = static_cast<Real>(stiffness_n_per_m);
  const Sums<Real> own = sum_samples(statics, tool, spacing), others = sum_samples(tool, statics, spacing);
  PlainAnswer out;
  if (!(own.weight > Real(0)) && !(others.weight > Real(0))) return out;
  out.contact = true;
  if (own.weight > Real(0)) out.depth = static_cast<double>(own.depth / own.weight);
  for (std::size_t k = 0; k < 3; ++k)  // a tool's face pushes the other way
    out.force[static_cast<int>(k)] =
        static_cast<double>(stiffness * ((own.push[k] - others.push[k]) / area / Real(2)));
  return out;
}

template PlainAnswer plain_response<float>(const Mesh&, const Mesh&, const Pose&, double, double, double);
template PlainAnswer plain_response<double>(const Mesh&, const Mesh&, const Pose&, double, double, double);

}  // namespace palpate

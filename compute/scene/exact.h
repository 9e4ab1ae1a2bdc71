#pragma once
#include <algorithm>
#include <array>
#include <cstdint>
#include <cstdlib>
#include <glm/common.hpp>

#include "model/lattice/sample_grid.h"
#include "model/lattice/vector.h"

namespace palpate::exact {

/// Exact answers about lattice triangles on the host, as docs/EXACTNESS.md section 1 defines them.
/// Coordinates are within 2^28 and a few voxels: differences within 2^29 + 1, raw normals within 2^59.2 a
/// component, what is multiplied with them within 2^30, so that every sum fits 128 bits with room to spare.
/// No function allocates.
__extension__ using Wide = __int128;

using Corners = std::array<Int3, 3>;

/// (b − a) × (c − a).
struct Normal {
  std::int64_t x, y, z;
  bool operator==(const Normal&) const = default;
};
inline Normal cross(const Int3& u, const Int3& v) {
  return {std::int64_t{u.y} * v.z - std::int64_t{u.z} * v.y,
          std::int64_t{u.z} * v.x - std::int64_t{u.x} * v.z,
          std::int64_t{u.x} * v.y - std::int64_t{u.y} * v.x};
}
inline Normal raw_normal(const Int3& a, const Int3& b, const Int3& c) { return cross(b - a, c - a); }
inline Normal raw_normal(const Corners& t) { return raw_normal(t[0], t[1], t[2]); }

inline Wide dot(const Normal& n, const Int3& d) {
  return Wide{n.x} * d.x + Wide{n.y} * d.y + Wide{n.z} * d.z;
}

template <class Integer>
int sign(Integer v) {
  return v < 0 ? -1 : v > 0 ? 1 : 0;
}

/// Whether two closed triangles share a point: touching and coplanar overlap count. Neither may be collapsed;
/// `t_normal` is t's.
bool triangles_meet(const Corners& s, const Corners& t, const Normal& t_normal);

/// A closed box.
struct Box {
  Int3 low, high;
};
inline Box box_of(const Corners& t) {
  return {glm::min(glm::min(t[0], t[1]), t[2]), glm::max(glm::max(t[0], t[1]), t[2])};
}

/// Whether a closed triangle, not collapsed, touches the closed cube [low, low + side]. `box` is the
/// triangle's.
bool triangle_touches_cube(const Corners& t, const Box& box, const Int3& low, std::int32_t side);

/// The sign of the side of a triangle's plane on which it lies ahead of the perturbed p; n: its normal, a:
/// one of its corners.
int plane_ahead(const Normal& n, const Int3& p, const Int3& a);

/// +1 when the way from p to q, p ≠ q, both perturbed alike, leaves through the triangle's outward face, −1
/// when it enters, 0 when it does not cross. A collapsed triangle is not crossed.
int segment_crossing(const Int3& p, const Int3& q, const Corners& t);

/// Side of the edge from p to q on which the grid point (u, v), moved by (ε, ε²), lies (section 4).
/// Coordinates within 2^28 and a spacing.
int grid_side(std::int64_t pu, std::int64_t pv, std::int64_t qu, std::int64_t qv, std::int64_t u,
              std::int64_t v);

/// Calls take(sample, i, j) for each sample of a triangle (section 4) in the closed box [low, high], seen
/// along the triangle's sample axis k.
template <class Take>
void for_samples(const Corners& t, int k, std::int32_t spacing, const Int3& low, const Int3& high,
                 Take&& take) {
  const int iu = (k + 1) % 3, iv = (k + 2) % 3;
  const SampleGrid grid{spacing};
  const auto least = [&](int axis) {
    return std::int64_t{std::max(low[axis], std::min({t[0][axis], t[1][axis], t[2][axis]}))};
  };
  const auto most = [&](int axis) {
    return std::int64_t{std::min(high[axis], std::max({t[0][axis], t[1][axis], t[2][axis]}))};
  };
  const std::int64_t u0 = least(iu), u1 = most(iu), v0 = least(iv), v1 = most(iv);
  if (u0 > u1 || v0 > v1) return;
  const Normal n = raw_normal(t);
  const std::int64_t parts[3] = {n.x, n.y, n.z}, nk = parts[k];
  const int facing = nk < 0 ? -1 : 1;
  // Of a small triangle: |N_u|, |N_v| ≤ |N_k|, so that sums are within 2^62.
  const bool small = std::abs(nk) < std::int64_t{1} << 36 && u1 - u0 < 1 << 24 && v1 - v0 < 1 << 24 &&
                     std::abs(u0 - t[0][iu]) < 1 << 24 && std::abs(v0 - t[0][iv]) < 1 << 24;
  for (std::int64_t j = grid.cell(v0), last_j = grid.cell(v1), first_i = grid.cell(u0),
                    last_i = grid.cell(u1);
       j <= last_j; ++j)
    for (std::int64_t i = first_i; i <= last_i; ++i) {
      const std::int64_t u = grid.u(i, j), v = grid.v(i, j);
      if (u < u0 || u > u1 || v < v0 || v > v1) continue;
      bool within = true;
      for (std::size_t e = 0; e < 3 && within; ++e) {
        const Int3 &p = t[e], &q = t[(e + 1) % 3];
        within = grid_side(p[iu], p[iv], q[iu], q[iv], u, v) == facing;
      }
      if (!within) continue;
      // floor(a_k − (N_u (u − a_u) + N_v (v − a_v)) / N_k)
      Int3 p;
      if (small) {
        const std::int64_t over = -facing * (parts[iu] * (u - t[0][iu]) + parts[iv] * (v - t[0][iv])),
                           under = nk * facing, q = over / under;
        p[k] = t[0][k] + static_cast<std::int32_t>(over % under < 0 ? q - 1 : q);
      } else {
        const Wide over = -facing * (Wide{parts[iu]} * (u - t[0][iu]) + Wide{parts[iv]} * (v - t[0][iv])),
                   under = Wide{nk} * facing, q = over / under;
        p[k] = t[0][k] + static_cast<std::int32_t>(over % under < 0 ? q - 1 : q);
      }
      p[iu] = static_cast<std::int32_t>(u);
      p[iv] = static_cast<std::int32_t>(v);
      if (p[k] >= low[k] && p[k] <= high[k]) take(p, i, j);
    }
}

/// A direction from a sum of normals that is not 0 (section 6): shifted until the largest |component| is in
/// [2^28, 2^29), towards 0.
Int3 normalise(const Normal& sum);

}  // namespace palpate::exact

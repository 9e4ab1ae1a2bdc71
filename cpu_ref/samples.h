#pragma once
#include <cstdint>

#include "cpu_ref/exact.h"
#include "model/lattice_mesh.h"

namespace palpate::cpu_ref {

/// Whether the grid point g, given by its two coordinates beside `axis`, lies inside the triangle projected along `axis`,
/// after it is moved by (ε, ε²). The triangle's normal has a component along `axis`.
bool projection_holds(const Triangle& triangle, int axis, std::int64_t g_u, std::int64_t g_v);

/// The lattice point of the triangle's plane above (g_u, g_v), third coordinate rounded down.
Int3 raised(const Triangle& triangle, int axis, std::int64_t g_u, std::int64_t g_v);

/// Calls visit(point) for every sample of a triangle that lies in `clip` (EXACTNESS section 4).
template <class Visit>
void for_each_sample(const LatticeMesh& mesh, std::uint32_t id, std::int32_t spacing, const Box& clip, const Visit& visit) {
  if (mesh.collapsed(id)) return;
  const Triangle triangle = triangle_of(mesh, id);
  const int axis = mesh.sample_axis[id], u = (axis + 1) % 3, v = (axis + 2) % 3;
  const Box box = triangle.box();
  const auto first = [&](int k) { return -floor_divide(-std::int64_t{std::max(box.min[k], clip.min[k])}, std::int64_t{spacing}); };
  const auto last = [&](int k) { return floor_divide(std::int64_t{std::min(box.max[k], clip.max[k])}, std::int64_t{spacing}); };
  for (std::int64_t i = first(u); i <= last(u); ++i)
    for (std::int64_t j = first(v); j <= last(v); ++j) {
      if (!projection_holds(triangle, axis, i * spacing, j * spacing)) continue;
      const Int3 point = raised(triangle, axis, i * spacing, j * spacing);
      if (clip.min[axis] <= point[axis] && point[axis] <= clip.max[axis]) visit(point);
    }
}

}  // namespace palpate::cpu_ref

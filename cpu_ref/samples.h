#pragma once
#include <cstdint>

#include "cpu_ref/exact.h"
#include "model/lattice/lattice_mesh.h"

namespace palpate::cpu_ref {

/// Whether the grid point g, given by its two coordinates beside `axis`, lies inside the triangle projected
/// along `axis`, after it is moved by (ε, ε²). The triangle's normal has a component along `axis`.
bool projection_holds(const Triangle& triangle, int axis, std::int64_t g_u, std::int64_t g_v);

/// The lattice point of the triangle's plane above (g_u, g_v), third coordinate rounded down.
Int3 raised(const Triangle& triangle, int axis, std::int64_t g_u, std::int64_t g_v);

/// A cell of a body's grid of samples, seen along an axis.
struct Cell {
  std::int64_t i = 0, j = 0;
  bool operator==(const Cell&) const = default;
};

/// The fractional part of n times the golden ratio, in 2^-32.
std::int64_t golden_part(std::int64_t n);

/// Where the sample of a cell is, along u and along v.
Cell sample_of(const Cell& cell, std::int32_t spacing);

/// The last level that the sample of a cell is of, at most kSampleLevels.
int level_of(Cell cell);

/// Calls visit(point) for every sample of a triangle that lies in `clip` (EXACTNESS section 4).
template <class Visit>
void for_each_sample(const LatticeMesh& mesh, std::uint32_t id, std::int32_t spacing, const Box& clip,
                     const Visit& visit) {
  if (mesh.collapsed(id)) return;
  const Triangle triangle = triangle_of(mesh, id);
  const int axis = mesh.sample_axis[id], u = (axis + 1) % 3, v = (axis + 2) % 3;
  const Box box = triangle.box();
  const auto first = [&](int k) {
    return floor_divide(std::int64_t{std::max(box.min[k], clip.min[k])}, std::int64_t{spacing});
  };
  const auto last = [&](int k) {
    return floor_divide(std::int64_t{std::min(box.max[k], clip.max[k])}, std::int64_t{spacing});
  };
  for (std::int64_t i = first(u); i <= last(u); ++i)
    for (std::int64_t j = first(v); j <= last(v); ++j) {
      const Cell at = sample_of({i, j}, spacing);
      if (!projection_holds(triangle, axis, at.i, at.j)) continue;
      const Int3 point = raised(triangle, axis, at.i, at.j);
      if (glm::all(glm::lessThanEqual(clip.min, point)) && glm::all(glm::lessThanEqual(point, clip.max)))
        visit(point);
    }
}

}  // namespace palpate::cpu_ref

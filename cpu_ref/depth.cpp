#include "cpu_ref/depth.h"

#include <algorithm>
#include <array>
#include <cstdlib>
#include <glm/common.hpp>

#include "cpu_ref/direction.h"
#include "cpu_ref/ray.h"

namespace palpate::cpu_ref {
namespace {

/// floor(√v), v below 2^63.
std::int64_t root(std::int64_t v) {
  std::int64_t low = 0, high = std::int64_t{3037000500};
  while (high - low > 1) {
    const std::int64_t middle = (low + high) / 2;
    (middle * middle <= v ? low : high) = middle;
  }
  return low;
}

constexpr std::int64_t kRounding = 16;  // steps by which `distance` may be off, and more

std::int64_t product(const Long3& a, const Long3& b) { return a.x * b.x + a.y * b.y + a.z * b.z; }

}  // namespace

std::uint32_t distance(const LatticeMesh& mesh, std::uint32_t triangle, const Int3& point) {
  const Long3 n(mesh.unit_normal_q30[triangle]);
  // Above the plane: 3 · 2^30 · 2^29.6.
  const std::int64_t height =
      std::llabs((product(n, difference(point, mesh.corner(triangle, 0))) + (std::int64_t{1} << 29)) >> 30);
  std::int64_t least = -1;  // squared, to the edges that have the point on their outer side
  for (int k = 0; k < 3; ++k) {
    const Int3 &u = mesh.corner(triangle, k), &v = mesh.corner(triangle, (k + 1) % 3);
    const Long3 edge = difference(v, u), from = difference(point, u);
    const Long3 along(normalise(edge));  // within 2^29
    Long3 out = cross(along, n);         // within 2^60
    for (int c = 0; c < 3; ++c) out[c] >>= 30;
    const std::int64_t size = root(product(along, along));  // below 2^30
    const std::int64_t side = floor_divide(product(out, from), size);
    if (side <= 0) continue;
    const std::int64_t at = floor_divide(product(along, from), size), length = root(product(edge, edge));
    const std::int64_t over = std::max({std::int64_t{0}, -at, at - length});
    const std::int64_t squared = height * height + side * side + over * over;  // within 3 · 2^60
    if (least < 0 || squared < least) least = squared;
  }
  if (least >= 0) return static_cast<std::uint32_t>(root(least));
  // A needle thinner than a step has ends that its sides say nothing of: its box does.
  Box box;
  for (int k = 0; k < 3; ++k) box.include(mesh.corner(triangle, k));
  const Long3 gap(glm::max(glm::max(difference(box.min, point), difference(point, box.max)), Long3(0)));
  const std::int64_t to_box = root(product(gap, gap));
  return static_cast<std::uint32_t>(to_box > height + kRounding ? to_box : height);
}

Int3 way_out(const LatticeMesh& mesh, std::uint32_t triangle, std::uint32_t steps, const Int3& point) {
  constexpr std::uint32_t kLeast = 64;  // steps
  const Int3& n = mesh.unit_normal_q30[triangle];
  if (steps < kLeast) return n;
  const std::int64_t above =
      (product(Long3(n), difference(point, mesh.corner(triangle, 0))) + (std::int64_t{1} << 29)) >> 30;
  std::int64_t least = -1;
  Long3 way(0);
  for (int k = 0; k < 3; ++k) {
    const Int3 &u = mesh.corner(triangle, k), &v = mesh.corner(triangle, (k + 1) % 3);
    const Long3 edge = difference(v, u), from = difference(point, u), along(normalise(edge));
    Long3 out = cross(along, Long3(n));
    for (int c = 0; c < 3; ++c) out[c] >>= 30;
    const std::int64_t size = root(product(along, along)), length = root(product(edge, edge));
    const std::int64_t side = floor_divide(product(out, from), size),
                       at = floor_divide(product(along, from), size);
    if (side <= 0) continue;
    const std::int64_t on = std::clamp(at, std::int64_t{0}, length), over = std::llabs(at - on);
    const std::int64_t squared = above * above + side * side + over * over;
    if (least >= 0 && squared >= least) continue;
    least = squared;
    for (int c = 0; c < 3; ++c) way[c] = floor_divide(along[c] * on, size) - from[c];
  }
  if (least < 0) return above > 0 ? -n : n;
  const Long3 scaled(normalise(way));
  const std::int64_t size = root(product(scaled, scaled));
  Int3 unit;
  for (int c = 0; c < 3; ++c)
    unit[c] = static_cast<std::int32_t>(floor_divide(scaled[c] * (std::int64_t{1} << 30), size));
  return unit;
}

std::optional<Depth> nearest(const LatticeMesh& mesh, const BoxTree& tree, const Int3& point) {
  std::optional<Depth> best;
  std::vector<std::uint32_t> near;
  const auto within = [&](std::int64_t reach) {
    const auto limit = [](std::int64_t v) {
      return static_cast<std::int32_t>(std::clamp<std::int64_t>(v, -(1 << 30), 1 << 30));
    };
    Box box;
    for (int k = 0; k < 3; ++k) {
      box.min[k] = limit(point[k] - reach);
      box.max[k] = limit(point[k] + reach);
    }
    near.clear();
    tree.meeting(box, near);
    for (const std::uint32_t t : near) {
      if (mesh.collapsed(t) || is_sheet(mesh, t)) continue;
      const std::uint32_t steps = distance(mesh, t, point);
      if (!best || steps < best->steps)
        best = Depth{steps, t};  // ascending ids: a tie stays with the smallest
    }
  };
  // Cubes twice as large each time until one holds something; whatever is nearer than that lies in a cube of
  // its distance, and rounding.
  for (std::int64_t reach = 1024; !best && reach <= std::int64_t{1} << 31; reach *= 2) within(reach);
  if (best) {
    const std::int64_t reach = best->steps + kRounding;
    best.reset();
    within(reach);
  }
  return best;
}

bool inside_mockup(const Frame& frame, const Int3& point) {
  const VoxelClass voxel_class = frame.scene.mockup.class_of(point);
  if (voxel_class != VoxelClass::kBoundary) return voxel_class == VoxelClass::kInternal;
  const LatticeMesh& mesh = frame.mockup();
  if (!mesh.closed) return frame.open_mockup.inside(point);
  std::vector<std::uint32_t> candidates;
  const Int3 along_x(1, 0, 0);
  frame.scene.mockup_tree.along_ray(point, along_x, candidates);
  int winding = 0;
  for (const std::uint32_t s : candidates)
    if (const auto crossing = ray_crosses(point, along_x, triangle_of(mesh, s))) winding += crossing->sign;
  return winding != 0;
}

}  // namespace palpate::cpu_ref

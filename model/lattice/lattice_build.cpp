#include "model/lattice/lattice_build.h"

#include <fmt/format.h>
#include <algorithm>
#include <cmath>

#include "model/scene/geometry_build.h"

namespace palpate {
namespace {

double largest(const Vec3& v) { return std::max({v.x, v.y, v.z}); }

std::int32_t floor_divide(std::int32_t a, std::int32_t b) { return a / b - (a % b < 0 ? 1 : 0); }  // b > 0

}  // namespace

Result<Box> bounding_box(const Mesh& mesh, const char* what) {
  if (mesh.triangles.empty()) return bad_value(fmt::format("the {} has no triangles", what));
  Box box{Vec3(HUGE_VAL), Vec3(-HUGE_VAL)};
  for (std::size_t t = 0; t < mesh.triangles.size(); ++t)
    for (const std::uint32_t v : mesh.triangles[t]) {
      if (v >= mesh.vertices.size())
        return bad_value(fmt::format("{}, triangle {}: vertex index {} is beyond the vertex list (size {})",
                                     what, t, v, mesh.vertices.size()));
      const Vec3& point = mesh.vertices[v];
      for (int k = 0; k < 3; ++k)
        if (!(std::abs(point[k]) <= kLargestCoordinate))
          return bad_value(fmt::format("{}, vertex {}: coordinate {} m is not a number within ±{} m", what, v,
                                       point[k], kLargestCoordinate));
      box.min = glm::min(box.min, point);
      box.max = glm::max(box.max, point);
    }
  return box;
}

Result<Lattice> choose_lattice(const Box& mockup, double arm_m, double voxel_m) {
  if (!(largest(mockup.size()) >= kSmallestExtent))
    return bad_value(fmt::format("the mock-up's largest side is {} m, the smallest that makes sense is {} m",
                                 largest(mockup.size()), kSmallestExtent));
  // Whatever is asked of a predicate lies within: half the mock-up, its grid's padding, the tool's centre as
  // far out as its sphere still meets the grid, and the sphere's other half. 64 steps stand for all
  // roundings.
  const double reach_m = largest(mockup.size()) / 2 + kGridPadding * voxel_m + 2 * arm_m;
  const double reach_steps =
      kLatticeReach - 64 - 8 * kGridPadding;  // a voxel has 8 steps even if 0 was asked for
  int exponent = std::ilogb(reach_m / reach_steps);
  if (std::ldexp(1.0, exponent) * reach_steps < reach_m) ++exponent;
  // No finer than the doubles of the file are, so that the origin, and every vertex less the origin, is
  // exact.
  const Vec3 farthest = glm::max(glm::abs(mockup.min), glm::abs(mockup.max));
  exponent = std::max(exponent, std::ilogb(largest(farthest)) - 51);
  Lattice lattice;
  lattice.step_m = std::ldexp(1.0, exponent);
  lattice.origin_m = on_lattice(mockup.centre(), lattice.step_m);
  return lattice;
}

Vec3 on_lattice(const Vec3& point_m, double step_m) {
  Vec3 out;
  for (int k = 0; k < 3; ++k) out[k] = std::nearbyint(point_m[k] / step_m) * step_m;
  return out;
}

Result<Lattice> choose_lattice(const Mesh& mockup, const Mesh& tool) {
  const Result<Box> mockup_box = bounding_box(mockup, "mock-up");
  if (!mockup_box) return mockup_box.error();
  if (tool.triangles.empty()) return choose_lattice(*mockup_box, 0, 0);
  const Result<Box> tool_box = bounding_box(tool, "tool");
  if (!tool_box) return tool_box.error();
  return choose_lattice(*mockup_box, length(tool_box->size()) / 2,
                        largest(tool_box->size()) / kVoxelsPerTool);
}

VoxelGrid make_grid(const Int3& box_min, const Int3& box_max, std::int32_t size) {
  VoxelGrid grid;
  grid.size = size;
  for (int k = 0; k < 3; ++k) {
    const std::int32_t first = floor_divide(box_min[k], size) - 2;
    const std::int32_t voxels = floor_divide(box_max[k], size) + 3 - first;
    grid.origin[k] = first * size;
    grid.bricks[k] = (voxels + kBrickSide - 1) / kBrickSide;
  }
  return grid;
}

}  // namespace palpate

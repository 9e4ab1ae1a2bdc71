#include "model/lattice/voxel_size.h"

#include <fmt/format.h>
#include <algorithm>
#include <cmath>

#include "model/lattice/lattice_build.h"
#include "model/scene/geometry_build.h"

namespace palpate {
namespace {

// What a touched voxel and an exact test of two triangles cost, relative to each other (chosen).
constexpr double kVoxelCost = 4;
constexpr double kPairCost = 1;

/// Expected voxels that a surface touches: a plane of area A meets 1.5 A/V² cubes, averaged over its
/// directions.
double touched_voxels(const SurfaceMeasure& body, double v) { return 1.5 * body.area / (v * v); }

/// Expected entries of their lists: a convex flat piece touches about (its area's voxels) + (its length's
/// voxels) + 1.
double entries(const SurfaceMeasure& body, double v) {
  return touched_voxels(body, v) + body.longest_edges / v + body.triangles;
}

/// Expected work of a frame in which the whole tool lies on mock-up: docs/VOXEL_SIZE.md.
double cost(const SurfaceMeasure& mockup, const SurfaceMeasure& tool, double v) {
  const double static_density = entries(mockup, v) / touched_voxels(mockup, v);
  const double mobile_density = entries(tool, v) / touched_voxels(tool, v);
  return touched_voxels(tool, v) * (kVoxelCost + kPairCost * static_density * mobile_density);
}

double bricks(const VoxelSubject& body, std::int32_t v) {
  const Int3 count = make_grid(body.box_min, body.box_max, v).bricks;
  return static_cast<double>(count.x) * count.y * count.z;
}

/// The limit that a size breaks, as the end of a sentence; empty if none.
std::string broken_limit(const VoxelSubject& body, const char* what, std::int32_t v) {
  if (const double n = bricks(body, v); n > kMaxBricks)
    return fmt::format("needs {:.0f} bricks for the {}, the limit is {:.0f}", n, what, kMaxBricks);
  if (const double n = touched_voxels(body.measure, v); n > kMaxBoundaryVoxels)
    return fmt::format("needs about {:.0f} boundary voxels for the {}, the limit is {:.0f}", n, what,
                       kMaxBoundaryVoxels);
  const double limit = std::max(kMaxVoxelEntries, 8 * body.measure.triangles);
  if (const double n = entries(body.measure, v); n > limit)
    return fmt::format("needs about {:.0f} entries in the voxels' lists for the {}, the limit is {:.0f}", n,
                       what, limit);
  return {};
}

/// Whether every back end takes a body's grid.
bool short_enough(const VoxelSubject& body, std::int32_t v) {
  const Int3 count = make_grid(body.box_min, body.box_max, v).bricks;
  return std::max({count.x, count.y, count.z}) <= kMaxAutoBricksAlong;
}

std::int32_t largest_side(const VoxelSubject& body) {
  const Int3 size = body.box_max - body.box_min;
  return std::max({size.x, size.y, size.z});
}

std::int32_t even(double steps) { return 2 * static_cast<std::int32_t>(std::nearbyint(steps / 2)); }

}  // namespace

Result<std::int32_t> choose_voxel_size(const VoxelSubject& mockup, const VoxelSubject& tool, double step_m,
                                       std::optional<double> asked_m) {
  const auto fits = [&](std::int32_t v) {
    return broken_limit(mockup, "mock-up", v).empty() && broken_limit(tool, "tool", v).empty();
  };
  if (asked_m) {
    const double most = std::max(largest_side(mockup), largest_side(tool));
    if (!(*asked_m > 0) || !(*asked_m / step_m <= most))
      return bad_value(fmt::format(
          "voxel_size is {} m, it must be above 0 and no more than the largest side of the scene, {} m",
          *asked_m, most * step_m));
    const std::int32_t v = even(*asked_m / step_m);
    if (v < kSmallestVoxel)
      return bad_value(fmt::format("voxel_size is {} m, the smallest is {} m ({} lattice steps)", *asked_m,
                                   kSmallestVoxel * step_m, kSmallestVoxel));
    for (const auto& limit : {broken_limit(mockup, "mock-up", v), broken_limit(tool, "tool", v)})
      if (!limit.empty()) return bad_value(fmt::format("voxel_size of {} m {}", *asked_m, limit));
    return v;
  }
  // Every limit is kept from some size on. Sizes grow by a sixteenth: fine enough for a flat minimum.
  const std::int32_t upper = std::max(kSmallestVoxel, even(largest_side(tool) / kVoxelsPerTool - 1));
  std::int32_t best = 0;
  double least = HUGE_VAL;
  const auto consider = [&](std::int32_t v) {
    const double work = cost(mockup.measure, tool.measure, v);
    if (!fits(v) || !short_enough(mockup, v) || !short_enough(tool, v) || (best != 0 && work >= least))
      return;
    best = v;
    least = work;
  };
  std::int32_t v = kSmallestVoxel;
  const auto next = [](std::int32_t size) { return size + std::max(2, size / 32 * 2); };
  for (; v < upper; v = next(v)) consider(v);
  consider(upper);
  for (; v < kLatticeReach / 2 && best == 0; v = next(v)) consider(v);  // memory comes before resolution
  if (best == 0)
    return bad_value("no voxel size fits the limits: the mock-up or the tool has too many triangles");
  return best;
}

Result<std::int32_t> choose_sample_spacing(std::int32_t voxel_size, std::int32_t auto_voxel, double step_m,
                                           std::optional<double> asked_m) {
  const double least = std::max(1.0, std::ceil(voxel_size / double{kMaxSamplesPerVoxelSide}));
  if (!asked_m)
    return std::max(static_cast<std::int32_t>(least),
                    std::min(voxel_size, auto_voxel) / kSamplesPerVoxelSide);
  const double most = 8.0 * voxel_size;
  const double steps = std::nearbyint(*asked_m / step_m);
  if (!(steps >= least && steps <= most))
    return bad_value(
        fmt::format("sample_spacing is {} m, for a voxel of {} m it must lie between {} m and {} m", *asked_m,
                    voxel_size * step_m, least * step_m, most * step_m));
  return static_cast<std::int32_t>(steps);
}

}  // namespace palpate

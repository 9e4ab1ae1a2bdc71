#include "compute/scene/estimate.h"

#include <algorithm>

namespace palpate {
namespace {

// Entries of the lists over what areas and edges let expect (chosen; tests hold the whole against what was
// taken).
constexpr double kMoreEntries = 1.3;
constexpr double kFixed = double(96 << 20);  // runs of pairs and samples, tables of short scenes

constexpr double kOpenBrick = 25'000, kMostOpenBricks = 8192;  // compute/native/narrow_phase/inside_cells.cpp

struct Sizes {
  double body = 0, entries = 0, boundary = 0, bricks = 0;
};

Sizes sizes(const LatticeMesh& mesh, const SurfaceMeasure& m, const VoxelGrid& grid) {
  const auto triangles = static_cast<double>(mesh.triangles.size());
  const double v = grid.size;
  Sizes out;
  // Vertices, corners, flags, normals, weights, patches, begins of neighbours; neighbours.
  out.body = 12.0 * static_cast<double>(mesh.vertices.size()) + 40 * triangles +
             4.0 * static_cast<double>(mesh.neighbours.size());
  out.boundary = 1.5 * m.area / (v * v);
  out.entries = kMoreEntries * (out.boundary + m.longest_edges / v + triangles);
  out.bricks = static_cast<double>(grid.bricks.x) * grid.bricks.y * grid.bricks.z;
  return out;
}

/// While a body's lists are made: pairs of triangle and brick (about as many as triangles, with their
/// counts), pairs of triangle and voxel with the entries' voxels, and the lists twice, for sorting; bricks by
/// number and, mixed, with their parts.
double lists(const Sizes& s, double triangles) {
  return 20 * s.entries + 20 * triangles + 40 * s.boundary + 28 * s.bricks;
}

}  // namespace

std::uint64_t estimate_preparation(const SceneGeometry& geometry, const Plan& plan) {
  const Sizes mockup = sizes(geometry.mockup, geometry.mockup_surface, geometry.mockup_grid),
              tool = sizes(geometry.tool, geometry.tool_surface, geometry.tool_grid);
  double sum =
      kFixed + mockup.body + tool.body + lists(mockup, static_cast<double>(geometry.mockup.triangles.size()));
  if (plan.profile == Profile::kRefined)
    sum += 17 * lists(tool, static_cast<double>(geometry.tool.triangles.size()));  // and in finer voxels
  // Cells and quarters of an open tool's voxels, and tables of both while they are made.
  if (plan.profile == Profile::kRefined && !geometry.tool.closed)
    sum += kOpenBrick * std::min(tool.bricks, kMostOpenBricks);
  return static_cast<std::uint64_t>(std::min(sum, 1e18));  // beyond, numbers end; memory did long before
}

}  // namespace palpate

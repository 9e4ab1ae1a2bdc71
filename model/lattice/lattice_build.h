#pragma once
#include "model/lattice/lattice.h"
#include "model/mesh/mesh.h"
#include "model/result.h"

namespace palpate {

/// Axis-aligned box in metres.
struct Box {
  Vec3 min{0}, max{0};
  Vec3 centre() const { return min + (max - min) / 2.0; }
  Vec3 size() const { return max - min; }
};

/// The box of all vertices that a triangle names. Errors (kBadValue): no triangle, an index beyond the vertex
/// list, a coordinate that is not finite or beyond kLargestCoordinate.
Result<Box> bounding_box(const Mesh& mesh, const char* what);

inline constexpr double kLargestCoordinate = 1e9;  ///< m; more is a mistake in units (chosen)
inline constexpr double kSmallestExtent = 1e-9;    ///< m; less is a mistake in units (chosen)

/// Voxels that a padded grid may stick out of its body's box on one side, at most (EXACTNESS section 2: 3 and
/// 10).
inline constexpr double kGridPadding = 12;

/// A tool's largest side holds at least this many voxels of the `auto` size (chosen: samples, four to a
/// voxel, then resolve it to 1 %).
inline constexpr double kVoxelsPerTool = 24;

/// choose_lattice for known boxes. `voxel_m`: the largest voxel that may be used; `arm_m`: the farthest that
/// anything fixed to the tool lies from its box's centre, at least half the box's diagonal.
Result<Lattice> choose_lattice(const Box& mockup, double arm_m, double voxel_m);

/// Multiple of the step nearest to each coordinate; exact in double for any coordinate that choose_lattice
/// accepts.
Vec3 on_lattice(const Vec3& point_m, double step_m);

}  // namespace palpate

#pragma once
#include <cstdint>

#include "model/lattice/lattice.h"
#include "model/lattice/lattice_mesh.h"
#include "model/lattice/voxel_grid.h"
#include "model/mesh/mass.h"
#include "model/mesh/smooth_angle.h"

namespace palpate {

/// Default of SceneGeometry::contact_samples (docs/ACCURACY.md).
inline constexpr std::uint32_t kContactSamples = 1024;

/// Everything a back end needs to know of a scene's shape: integers only, the same for every back end.
struct SceneGeometry {
  Lattice lattice;
  LatticeMesh mockup;                           ///< world lattice frame
  LatticeMesh tool;                             ///< tool lattice frame: origin at the tool's box centre
  SurfaceMeasure mockup_surface, tool_surface;  ///< of the two meshes
  Vec3 tool_centre_m{0};         ///< tool frame of the file: where the tool's lattice origin lies
  Vec3 tool_gc_m{0};             ///< tool frame of the file: centre of mass
  Int3 tool_gc{0};               ///< the same in the tool's lattice frame, rounded to nearest
  std::int32_t tool_radius = 0;  ///< steps: ≥ |v| of every tool vertex + 2, Euclidean
  VoxelGrid mockup_grid;
  VoxelGrid tool_grid;                ///< in the tool's lattice frame, same voxel size
  std::int32_t sample_spacing = 0;    ///< of both bodies; steps, ≥ 1, ≥ voxel size / 63
  std::uint32_t contact_samples = 0;  ///< about so many samples of each body say what a contact pushes with;
                                      ///< larger ones are taken at a coarser level; 0: all
  double reference_area_m2 = 0;       ///< A_ref: a flat contact of this area is as stiff as K, m²
  double tool_gyration_m = 0;         ///< ρ: radius of gyration of the tool's surface about gc, m
  SmoothAngle smooth_angle;
  MeshReport mockup_report, tool_report;
};

}  // namespace palpate

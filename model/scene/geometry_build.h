#pragma once
#include <functional>
#include <optional>

#include "model/mesh/mesh.h"
#include "model/result.h"
#include "model/scene/scene_geometry.h"

namespace palpate {

/// Settings of a scene that shape its integers. Empty means `auto`.
struct GeometrySettings {
  std::optional<double> voxel_size_m{};      ///< rounded to an even number of steps, at least 8
  std::optional<double> sample_spacing_m{};  ///< default: choose_sample_spacing(); at least 1/63 of a voxel
  double smooth_angle_deg = 30;
  std::optional<Vec3>
      centre_of_mass_m{};  ///< tool frame of the file; default: of the volume, of the area when open
  std::uint32_t contact_samples = kContactSamples;
};

/// Chooses the lattice, snaps, welds, orients (METHOD section 2) both bodies, and sets both grids.
/// `mockup` in the world frame, `tool` in its own, metres. `go_on` is asked between steps; false ends it.
/// Errors (kBadValue): empty after snapping, too large for a limit; kInternal: ended.
Result<SceneGeometry> build_geometry(const Mesh& mockup, const Mesh& tool, const GeometrySettings& settings,
                                     const std::function<bool()>& go_on = {});

/// One body on a lattice of its own, for `info` and tests: as build_geometry does it for a mock-up.
Result<LatticeMesh> build_lattice_mesh(const Mesh& mesh, const Lattice& lattice, const SmoothAngle& angle,
                                       MeshReport& report, const std::function<bool()>& go_on = {});

/// The finest power-of-two step for which everything stays within kLatticeReach.
Result<Lattice> choose_lattice(const Mesh& mockup, const Mesh& tool);

/// The grid of docs/EXACTNESS.md section 2 for a box on the lattice and an even voxel size ≥ 8.
VoxelGrid make_grid(const Int3& box_min, const Int3& box_max, std::int32_t size);

}  // namespace palpate

#pragma once
#include <cstddef>
#include <string>
#include <vector>

#include "model/collision_backend.h"
#include "model/lattice/pose.h"
#include "model/result.h"
#include "model/scene/scene_geometry.h"

namespace palpate {

/// Files of an export, whatever its poses.
inline constexpr const char* kExportedFiles[] = {"lattice.json", "static.i32", "voxels.json", "voxels.u8"};

/// Writes what was judged, so that other software can check it (`query --export-geometry`), to `directory`,
/// made if missing: lattice.json (step_m, origin_m), static.i32 and tool_<pose>.i32 (little-endian int32, 9 a
/// triangle: its three corners in world lattice steps; metre = origin_m + step_m × value), voxels.json (size,
/// origin, counts in lattice steps) and voxels.u8 (0 ext, 1 bnd, 2 int; x fastest). A pose beyond the lattice
/// has no such coordinates and no file: `notes` says so. Replaces an export that is there, of more poses,
/// too.
Result<void> export_geometry(const std::string& directory, const SceneGeometry& geometry,
                             const CollisionBackend& backend, const std::vector<Pose>& poses,
                             std::vector<std::string>& notes);

/// Writes beside it pairs_<pose>.u32: the intersecting pairs of the back end's last query, two numbers each
/// (static id, mobile id), ascending.
Result<void> export_pairs(const std::string& directory, const CollisionBackend& backend, std::size_t pose);

}  // namespace palpate

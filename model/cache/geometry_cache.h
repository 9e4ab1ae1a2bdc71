#pragma once
#include <optional>
#include <string>
#include <vector>

#include "model/cache/disk_cache.h"
#include "model/scene/scene.h"

namespace palpate {

/// What loading a scene makes of its files.
struct LoadedGeometry {
  SceneGeometry geometry;
  std::vector<std::string> warnings;  ///< that loading adds to the scene's
};

/// Key of all that loading depends on: the program, the content of the mesh files, and the settings that
/// shape geometry. Empty: a file can't be read, or may draw on others whose content nobody knows here (.obj,
/// .gltf, a .glb with a "uri", and formats that are not known to stand alone).
std::optional<ContentKey> geometry_key(const Scene& scene);

/// Whether a mesh file can draw on no other file; false where that isn't known.
bool stands_alone(const std::string& path);

std::optional<LoadedGeometry> find_geometry(DiskCache& cache, const ContentKey& key);
/// `seconds`: what loading took.
void keep_geometry(DiskCache& cache, const ContentKey& key, const LoadedGeometry& loaded, double seconds);

/// Key of the geometry itself, for what is worked out from it (the reports of its making apart).
void add_geometry(KeyBuilder& key, const SceneGeometry& geometry);

}  // namespace palpate

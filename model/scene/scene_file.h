#pragma once
#include <functional>
#include <map>
#include <memory>
#include <optional>
#include <string>

#include "model/collision_backend.h"
#include "model/mesh/mesh_import.h"
#include "model/scene/scene.h"

namespace palpate {

class DiskCache;

/// Reads and checks a scene file; meshes are not opened yet. Errors name file, place in it, value and what is
/// allowed; an unknown key names the nearest known one. `profile` stands in place of the file's; a law that
/// the file does not name follows it.
Result<Scene> read_scene(const std::string& path, std::optional<Profile> profile = std::nullopt);

/// Meshes that somebody has in memory, by the name that a scene's "mesh" calls them by. Their own units:
/// "units" and "scale" hold as for a file.
using GivenMeshes = std::map<std::string, std::shared_ptr<const Mesh>>;

/// The same of a text. `name` stands for the file in sentences, and files that the text names lie beside it.
Result<Scene> read_scene_text(const std::string& text, const std::string& name, const GivenMeshes& given,
                              std::optional<Profile> profile = std::nullopt);

/// Imports or generates the meshes of a scene, and adds what is odd about them to its warnings. Reports
/// progress; may be cancelled. `limits` are each mesh file's; `folder` as in model/mesh/confined_import.h.
Result<SceneMeshes> import_scene(Scene& scene, const Progress& progress, const ImportLimits& limits = {},
                                 const std::string& folder = {});

/// import_scene, then the geometry of it; or both from `cache` (may be null), if the same program has made
/// them of the same files before.
Result<LoadedScene> load_scene(Scene scene, const Progress& progress, const ImportLimits& limits = {},
                               DiskCache* cache = nullptr, const std::string& folder = {});

}  // namespace palpate

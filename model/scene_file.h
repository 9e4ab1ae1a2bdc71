#pragma once
#include <functional>
#include <optional>
#include <string>

#include "model/collision_backend.h"
#include "model/mesh_import.h"
#include "model/scene.h"

namespace palpate {

/// Reads and checks a scene file; meshes are not opened yet. Errors name file, place in it, value and what is allowed;
/// an unknown key names the nearest known one. `profile` stands in place of the file's; a law that the file does not name follows it.
Result<Scene> read_scene(const std::string& path, std::optional<Profile> profile = std::nullopt);

/// Imports or generates the meshes of a scene and builds its geometry. Reports progress; may be cancelled. `limits` are each mesh file's.
Result<LoadedScene> load_scene(Scene scene, const Progress& progress, const ImportLimits& limits = {});

}  // namespace palpate

#pragma once
#include <optional>

#include "compute/native/prepare/scene.h"
#include "model/cache/disk_cache.h"

namespace palpate::native {

/// Key of all that preparation depends on: the program and the geometry.
ContentKey scene_key(const SceneGeometry& geometry);

/// The scene as an earlier preparation of this geometry left it; empty: there is none.
std::optional<Scene> find_scene(DiskCache& cache, const ContentKey& key);

/// `seconds`: what preparing took.
void keep_scene(DiskCache& cache, const ContentKey& key, const Scene& scene, double seconds);

}  // namespace palpate::native

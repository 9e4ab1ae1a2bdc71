#pragma once
#include <filesystem>

#include "service/server/http/router.h"
#include "service/server/queries/worker_pool.h"
#include "service/server/scenes/scene_store.h"

namespace palpate {

/// /v1/scenes: list, name, upload, look, follow, delete. `root` and `spool` are real paths; an empty root: no
/// scene can be named.
void add_scene_routes(Router& router, SceneStore& store, WorkerPool& workers, Metrics& metrics,
                      const ServerLimits& limits, const std::filesystem::path& root,
                      const std::filesystem::path& spool);

}  // namespace palpate

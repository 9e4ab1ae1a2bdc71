#pragma once
#include "service/server/http/router.h"
#include "service/server/queries/worker_pool.h"
#include "service/server/scenes/scene_store.h"

namespace palpate {

/// /v1/scenes/{id}/geometry, …/triangles and …/voxels: what a viewer draws.
void add_drawing_routes(Router& router, SceneStore& store, WorkerPool& workers, const ServerLimits& limits);

}  // namespace palpate

#pragma once
#include "service/server/router.h"
#include "service/server/scene_store.h"
#include "service/server/worker_pool.h"

namespace palpate {

/// /v1/scenes/{id}/geometry, …/triangles and …/voxels: what a viewer draws.
void add_drawing_routes(Router& router, SceneStore& store, WorkerPool& workers, const ServerLimits& limits);

}  // namespace palpate

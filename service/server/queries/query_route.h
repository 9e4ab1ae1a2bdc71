#pragma once
#include "service/server/http/router.h"
#include "service/server/queries/batch_queue.h"
#include "service/server/queries/worker_pool.h"
#include "service/server/scenes/scene_store.h"

namespace palpate {

/// POST /v1/scenes/{id}/query.
void add_query_route(Router& router, SceneStore& store, BatchQueue& batches, WorkerPool& workers,
                     const ServerLimits& limits);

}  // namespace palpate

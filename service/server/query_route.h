#pragma once
#include "service/server/batch_queue.h"
#include "service/server/router.h"
#include "service/server/scene_store.h"
#include "service/server/worker_pool.h"

namespace palpate {

/// POST /v1/scenes/{id}/query.
void add_query_route(Router& router, SceneStore& store, BatchQueue& batches, WorkerPool& workers, const ServerLimits& limits);

}  // namespace palpate

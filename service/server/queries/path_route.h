#pragma once
#include <atomic>

#include "service/server/http/router.h"
#include "service/server/queries/worker_pool.h"
#include "service/server/scenes/scene_store.h"

namespace palpate {

/// POST /v1/scenes/{id}/path: poses in, the page of `palpate path` out. One at a time.
void add_path_route(Router& router, SceneStore& store, WorkerPool& workers, const ServerLimits& limits,
                    const std::atomic<bool>& stopping);

}  // namespace palpate

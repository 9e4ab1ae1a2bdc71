#pragma once
#include <filesystem>

#include "service/server/http/router.h"
#include "service/server/queries/worker_pool.h"

namespace palpate {

/// /v1/runs: recorded runs below `root` (a real path; empty: none).
void add_run_routes(Router& router, WorkerPool& workers, const std::filesystem::path& root);

}  // namespace palpate

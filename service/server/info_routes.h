#pragma once
#include <atomic>
#include <string>

#include "service/cli/cli.h"
#include "service/server/http/limits.h"
#include "service/server/http/router.h"
#include "service/server/metrics.h"
#include "service/server/queries/worker_pool.h"
#include "service/server/scenes/scene_store.h"
#include "service/server/sessions/session_host.h"

namespace palpate {

/// What the routes below tell of; all outlives them.
struct InfoSources {
  const Parts& parts;
  const ServerLimits& limits;
  Metrics& metrics;
  SceneStore& store;
  SessionHost& sessions;
  WorkerPool& workers;
  const std::atomic<bool>& stopping;
  std::string backend;  ///< as SceneOptions::backend
};

/// /healthz, /readyz, /metrics, /openapi.json, /v1/info, /v1/devices and the viewer's files at /.
void add_info_routes(Router& router, InfoSources sources);

}  // namespace palpate

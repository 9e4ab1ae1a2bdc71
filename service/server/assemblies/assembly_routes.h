#pragma once
#include <filesystem>

#include "service/server/assemblies/assembly_store.h"
#include "service/server/http/router.h"
#include "service/server/metrics.h"
#include "service/server/queries/worker_pool.h"
#include "service/server/scenes/scene_store.h"

namespace palpate {

/// Uploads to be looked at before there is a scene: `/v1/assemblies` of docs/SERVICE.md. All references must
/// outlive the router.
void add_assembly_routes(Router& router, AssemblyStore& assemblies, SceneStore& store, WorkerPool& workers,
                         Metrics& metrics, const ServerLimits& limits, const std::filesystem::path& root,
                         const std::filesystem::path& spool);

}  // namespace palpate

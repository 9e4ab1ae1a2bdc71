#pragma once
#include <filesystem>
#include <functional>
#include <memory>

#include "service/server/http/http_message.h"
#include "service/server/http/limits.h"
#include "service/server/metrics.h"
#include "service/server/queries/worker_pool.h"
#include "service/server/scenes/scene_content.h"

namespace palpate {

/// Writes an upload of a scene (docs/SERVICE.md) to a new folder below `spool`, a piece at a time, and then,
/// on `workers`, calls `done` with what it holds, or replies with a problem. What does not get that far
/// leaves nothing behind.
std::unique_ptr<BodySink> receive_upload(const HttpRequest& request, const std::filesystem::path& spool,
                                         const ServerLimits& limits, Metrics& metrics, WorkerPool& workers,
                                         std::function<void(SceneContent, Reply)> done);

}  // namespace palpate

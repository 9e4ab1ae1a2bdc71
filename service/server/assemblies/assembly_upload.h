#pragma once
#include <functional>
#include <memory>
#include <vector>

#include "service/server/assemblies/assembly_store.h"
#include "service/server/http/http_message.h"
#include "service/server/metrics.h"

namespace palpate {

/// A multipart upload of parts `file`: written to a folder of its own below `spool` as it comes. `done` gets
/// the folder and what lies in it.
std::unique_ptr<BodySink> receive_assembly(
    const HttpRequest& request, const std::filesystem::path& spool, const ServerLimits& limits,
    Metrics& metrics,
    std::function<void(std::shared_ptr<SpoolFolder>, std::vector<AssemblyFile>, const Reply&)> done);

}  // namespace palpate

#pragma once
#include <memory>
#include <string>

#include "service/bench/bench.h"
#include "service/cli/console.h"
#include "service/cli/scene_host.h"

namespace palpate {

/// The scene of `file`, in the options' profile, on the engine `backend` ("": the scene's), with all that
/// frames need made: no frame is timed beside compilers. Errors: as prepare_scene().
Result<std::unique_ptr<HostedScene>> ready_scene(const BenchOptions& options, const std::string& file,
                                                 const std::string& backend, Purpose purpose,
                                                 const Parts& parts, Console& console);

/// The engines that the options name; one "" where they name none.
std::vector<std::string> asked_backends(const BenchOptions& options);

}  // namespace palpate

#pragma once
#include <vector>

#include "model/lattice/pose.h"
#include "service/bench/bench.h"
#include "service/cli/console.h"
#include "service/cli/scene_host.h"

namespace palpate {

/// Poses to measure at, in the order of the motion, `options.frames` of them, evenly spread: of the scene's
/// path, which is where the hand means to go and so deeper than it gets; of a file; or ("run") those at which
/// a run in virtual time asked the back end, which are also written to poses.csv in `options.out` (made if
/// missing), if that is named. Errors: the file; the run failed; interrupted.
Result<std::vector<Pose>> bench_poses(const BenchOptions& options, HostedScene& scene, const Parts& parts,
                                      Console& console);

}  // namespace palpate

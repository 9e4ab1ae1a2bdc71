#pragma once
#include <string>

#include "model/result.h"
#include "service/bench/bench.h"
#include "service/bench/error/error_subjects.h"
#include "service/cli/console.h"

namespace palpate {

/// A scene file as something whose error is measured: its meshes, the poses of its path or of a file, and
/// what it chose for itself.
struct SceneSubject {
  ErrorSubject subject;  ///< settings: the scene's own, `auto` worked out
  Profile profile = Profile::kRefined;
  double voxel_m = 0, spacing_m = 0;
};

/// Reads the scene and takes poses as `options` say. `backend`: "gpu" or "cpu", for a run that makes poses.
/// Errors: as prepare_scene and bench_poses.
Result<SceneSubject> scene_subject(const std::string& file, const BenchOptions& options,
                                   const std::string& backend, const Parts& parts, Console& console);

}  // namespace palpate

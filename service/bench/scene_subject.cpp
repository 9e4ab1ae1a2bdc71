#include "service/bench/scene_subject.h"

#include <utility>

#include "model/scene/scene_file.h"
#include "service/bench/poses.h"
#include "service/cli/scene_host.h"
#include "service/report/run_summary.h"

namespace palpate {

Result<SceneSubject> scene_subject(const std::string& file, const BenchOptions& options,
                                   const std::string& backend, const Parts& parts, Console& console) {
  auto hosted = prepare_scene({.scene = file, .backend = backend, .profile = options.profile},
                              Purpose::kQuery, parts, console);
  if (!hosted) return hosted.error();
  Result<std::vector<Pose>> poses = bench_poses(options, **hosted, parts, console);
  if (!poses) return poses.error();
  Scene read = (*hosted)->loaded.scene;
  const SceneGeometry& geometry = (*hosted)->loaded.geometry;
  SceneSubject out;
  out.profile = read.response.profile;
  out.voxel_m = geometry.mockup_grid.size * geometry.lattice.step_m;
  out.spacing_m = geometry.sample_spacing * geometry.lattice.step_m;
  hosted->reset();
  auto meshes =
      import_scene(read, [&](const char* what, double done) { return console.progress(what, done); });
  if (!meshes) return meshes.error();

  out.subject.name = scene_name(file);
  out.subject.meshes = std::move(*meshes);
  out.subject.stiffness_n_per_m = read.response.stiffness_n_per_m;
  out.subject.settings = {out.voxel_m, out.spacing_m, read.response.smooth_angle_deg,
                          read.tool.centre_of_mass_m, read.response.contact_samples};
  out.subject.poses = std::move(*poses);
  return out;
}

}  // namespace palpate

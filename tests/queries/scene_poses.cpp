#include "tests/queries/scene_poses.h"

#include <utility>

#include "model/files/path_file.h"
#include "model/lattice/rotation.h"
#include "model/scene/scene_file.h"
#include "tests/equivalence/touching_poses.h"

namespace palpate::queries {

Result<Subject> subject_of_file(const std::string& path) {
  auto scene = read_scene(path);
  if (!scene) return scene.error();
  auto loaded = load_scene(std::move(*scene), [](const char*, double) { return true; });
  if (!loaded) return loaded.error();
  Subject out{path, std::move(loaded->geometry), {}};
  for (const PathPoint& point : loaded->scene.device.path)
    out.path.push_back(path_pose(point, loaded->scene.device.guide));
  return out;
}

std::vector<LatticePose> poses_near(const SceneGeometry& geometry, std::size_t count, double reach,
                                    std::uint64_t seed) {
  constexpr std::size_t kChain = 8;
  equivalence::Random random(seed);
  std::vector<LatticePose> out;
  while (out.size() < count) {
    LatticePose pose = random.below(8) == 0
                           ? equivalence::aligned_touching_pose(geometry, random)
                           : equivalence::random_touching_pose(geometry, reach * random.unit(), random);
    for (std::size_t i = 0; i < kChain && out.size() < count; ++i) {
      out.push_back(pose);
      pose = equivalence::moved_on(pose, geometry.mockup_grid.size, random);
    }
  }
  return out;
}

std::vector<LatticePose> poses_along(const Subject& subject, std::size_t count, double reach,
                                     std::uint64_t seed) {
  equivalence::Random random(seed);
  const double voxel = subject.geometry.mockup_grid.size * subject.geometry.lattice.step_m;
  const auto some = [&] { return reach * (2 * random.unit() - 1); };
  std::vector<LatticePose> out;
  for (std::size_t i = 0; i < count; ++i) {
    const double at =
        static_cast<double>(i) / static_cast<double>(count) * static_cast<double>(subject.path.size() - 1);
    const auto before = static_cast<std::size_t>(at);
    const Pose &a = subject.path[before], &b = subject.path[before + 1];
    const double t = at - static_cast<double>(before);
    Pose pose{a.position + t * (b.position - a.position) + voxel * Vec3(some(), some(), some()),
              glm::normalize(glm::slerp(a.rotation, b.rotation, t) *
                             rotation_by(0.01 * Vec3(some(), some(), some())))};
    out.push_back(to_lattice(pose, subject.geometry).value());
  }
  return out;
}

}  // namespace palpate::queries

// The chapter's two scenes, smaller than they are there so that a test stays short.
#include "model/generate.h"
#include "tests/equivalence/case.h"
#include "tests/equivalence/mesh_scene.h"
#include "tests/equivalence/touching_poses.h"

namespace palpate::equivalence {
namespace {

Case chapter(const std::string& scene, std::uint64_t triangles, Profile profile, bool ignoring) {
  Case c;
  c.name = scene + (profile == Profile::kPaper ? "_paper" : "") + (ignoring ? "_ignoring" : "");
  c.family = "chapter";
  c.about = "the chapter's scene with " + std::to_string(triangles) + " triangles and a tool of 1000";
  c.profile = profile;
  c.ignoring = ignoring;
  c.share = 0.013;  // 110 ms a pose, asked twice
  c.poses = 8;
  c.make = [=](std::uint64_t) -> Result<TestScene> {
    const auto made = generate_scene(scene, triangles, 1000);
    if (!made) return made.error();
    return mesh_scene(made->mockup, made->tool, {},
                      [](const SceneGeometry& geometry, Random& random, Known&) {
                        return random_touching_pose(geometry, 1.0, random);
                      });
  };
  return c;
}

Case with_poses(Case c, int poses) {
  c.poses = poses;
  return c;
}

}  // namespace

std::vector<Case> chapter_cases() {
  std::vector<Case> cases;
  for (const auto& [scene, triangles] :
       {std::pair<const char*, std::uint64_t>{"contacts", 5000}, {"disassembly", 10000}}) {
    cases.push_back(chapter(scene, triangles, Profile::kRefined, false));
    cases.push_back(chapter(scene, triangles, Profile::kPaper, false));
    cases.push_back(chapter(scene, triangles, Profile::kRefined, true));
    cases.push_back(with_poses(coarser(chapter(scene, triangles, Profile::kRefined, false)), 24));
  }
  return cases;
}

}  // namespace palpate::equivalence

// The chapter's two scenes, smaller than they are there so that a test stays short.
#include <gtest/gtest.h>

#include "model/generate.h"
#include "tests/equivalence/equivalence_case.h"
#include "tests/equivalence/touching_poses.h"

namespace palpate {
namespace {

EquivalenceCase chapter_case(const char* scene, std::uint64_t triangles, std::uint64_t tool_triangles, Profile profile, bool held) {
  EquivalenceCase c;
  c.name = std::string(scene) + (profile == Profile::kPaper ? "_paper" : "") + (held ? "_held" : "");
  const auto made = [=] { return generate_scene(scene, triangles, tool_triangles).value(); };
  c.mockup = [=] { return made().mockup; };
  c.tool = [=] { return made().tool; };
  c.profile = profile;
  c.held = held;
  c.poses = 200;
  c.pose = [](const SceneGeometry& geometry, std::mt19937_64& random) { return random_touching_pose(geometry, 1.0, random); };
  return c;
}

class ChapterEquivalence : public testing::TestWithParam<EquivalenceCase> {};
TEST_P(ChapterEquivalence, BothBackEndsGiveTheSameIntegers) { expect_equal_answers(GetParam()); }

INSTANTIATE_TEST_SUITE_P(All, ChapterEquivalence,
                         testing::Values(chapter_case("contacts", 5000, 1000, Profile::kRefined, false),
                                         chapter_case("contacts", 5000, 1000, Profile::kPaper, false),
                                         chapter_case("contacts", 5000, 1000, Profile::kRefined, true),
                                         chapter_case("disassembly", 20000, 1000, Profile::kRefined, false),
                                         chapter_case("disassembly", 20000, 1000, Profile::kPaper, false),
                                         chapter_case("disassembly", 20000, 1000, Profile::kRefined, true)),
                         [](const auto& made) { return made.param.name; });

}  // namespace
}  // namespace palpate

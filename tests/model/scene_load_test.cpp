// From a scene file to the triangles and integers that a back end gets: parts taken out and left out, bodies
// placed, warnings.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <utility>

#include "model/scene/scene_file.h"
#include "temporary_folder.h"

namespace palpate {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;

/// An OBJ box of 12 triangles as object `name`, `first` being its first vertex' number.
std::string box(const std::string& name, double x, double size, int first) {
  std::string text = "o " + name + "\n";
  for (int corner = 0; corner < 8; ++corner)
    text += "v " + std::to_string(x + (corner & 1 ? size : 0)) + " " + std::to_string(corner & 2 ? size : 0) +
            " " + std::to_string(corner & 4 ? size : 0) + "\n";
  const int quads[6][4] = {{0, 2, 3, 1}, {4, 5, 7, 6}, {0, 1, 5, 4},
                           {2, 6, 7, 3}, {0, 4, 6, 2}, {1, 3, 7, 5}};
  for (const auto& q : quads)
    for (const auto& [b, c] : {std::pair{1, 2}, std::pair{2, 3}})
      text += "f " + std::to_string(first + q[0]) + " " + std::to_string(first + q[b]) + " " +
              std::to_string(first + q[c]) + "\n";
  return text;
}

class SceneLoad : public testing::Test {
 protected:
  SceneLoad() {
    folder.write("two.obj", box("left", 0, 0.1, 1) + box("right", 0.5, 0.2, 9));
    folder.write("tool.obj", box("tool", 0, 0.05, 1));
    folder.write("open.obj", "v 0 0 0\nv 0.1 0 0\nv 0 0.1 0\nf 1 2 3\n");
  }
  Result<Scene> read(const std::string& statics, const std::string& tool) {
    return read_scene(folder.write("s.json", R"({"static": [)" + statics + R"(], "tool": {)" + tool + "}}"));
  }
  Result<LoadedScene> load(const std::string& statics, const std::string& tool,
                           const Progress& progress = {}) {
    auto scene = read(statics, tool);
    if (!scene) return scene.error();
    return load_scene(std::move(*scene), progress);
  }
  Result<SceneMeshes> import(const std::string& statics, const std::string& tool) {
    auto scene = read(statics, tool);
    if (!scene) return scene.error();
    return import_scene(*scene, {});
  }
  std::string refusal(const std::string& statics, const std::string& tool) {
    const auto loaded = load(statics, tool);
    EXPECT_FALSE(loaded);
    if (loaded) return "";
    EXPECT_EQ(loaded.error().code, ErrorCode::kBadValue);
    return loaded.error().sentence;
  }
  TemporaryFolder folder;
};

std::vector<std::string> paths(const Mesh& mesh) {
  std::vector<std::string> out;
  for (const MeshPart& part : mesh.parts) out.push_back(part.path);
  return out;
}

TEST_F(SceneLoad, TheToolIsThePartNamedAndTheMockUpTheRest) {
  const char *statics = R"({"mesh": "two.obj", "without": ["right"]})",
             *tool = R"("mesh": "two.obj", "part": "right")";
  const auto meshes = import(statics, tool);
  ASSERT_TRUE(meshes) << meshes.error().sentence;
  EXPECT_THAT(paths(meshes->mockup), ElementsAre("two.obj/left"));
  EXPECT_THAT(paths(meshes->tool), ElementsAre("two.obj/right"));
  EXPECT_EQ(meshes->mockup.triangles.size(), 12u);
  const auto loaded = load(statics, tool);
  ASSERT_TRUE(loaded) << loaded.error().sentence;
  EXPECT_EQ(loaded->geometry.mockup.triangles.size(), 12u);
  // The part keeps its place in its file: the box of 0.2 m that begins at x = 0.5 m.
  const auto& vertices = meshes->tool.vertices;
  EXPECT_FLOAT_EQ(static_cast<float>(std::min_element(vertices.begin(), vertices.end(),
                                                      [](const Vec3& a, const Vec3& b) { return a.x < b.x; })
                                         ->x),
                  0.5f);
  EXPECT_THAT(loaded->scene.warnings, IsEmpty());
}

TEST_F(SceneLoad, BodiesArePlacedAndTheirPartsToldApart) {
  const auto meshes =
      import(R"({"mesh": "two.obj"}, {"mesh": "tool.obj", "position": [0, 0, 2], "units": "m"})",
             R"("mesh": "tool.obj")");
  ASSERT_TRUE(meshes) << meshes.error().sentence;
  EXPECT_THAT(paths(meshes->mockup),
              ElementsAre("two/two.obj/left", "two/two.obj/right", "tool/tool.obj/tool"));
  EXPECT_EQ(meshes->mockup.parts[2].first_triangle, 24u);
  double highest = 0;
  for (const Vec3& v : meshes->mockup.vertices) highest = std::max(highest, v.z);
  EXPECT_NEAR(highest, 2.05, 1e-6);  // coordinates are floats in the importing library
}

TEST_F(SceneLoad, WrongPartsAreRefusedWithFileAndNearestName) {
  EXPECT_THAT(refusal(R"({"mesh": "two.obj", "without": ["rigth"]})", R"("mesh": "tool.obj")"),
              testing::AllOf(HasSubstr("two.obj"), HasSubstr("no node named 'rigth'"),
                             HasSubstr("did you mean 'right'")));
  EXPECT_THAT(refusal(R"({"mesh": "two.obj", "without": ["left", "right"]})", R"("mesh": "tool.obj")"),
              HasSubstr("nothing is left of"));
  EXPECT_THAT(refusal(R"({"mesh": "two.obj"})", R"("mesh": "two.obj", "part": "middle")"),
              HasSubstr("no node named 'middle'"));
  EXPECT_THAT(refusal(R"({"mesh": "two.obj"})", R"("mesh": "missing.obj")"), HasSubstr("missing.obj"));
}

TEST_F(SceneLoad, APartThatVanishesOnTheLatticeIsWarnedOf) {
  const auto loaded =
      load(R"({"mesh": "two.obj"}, {"mesh": "tool.obj", "scale": 1e-12})", R"("mesh": "tool.obj")");
  ASSERT_TRUE(loaded) << loaded.error().sentence;
  EXPECT_THAT(loaded->scene.warnings,
              ElementsAre(testing::AllOf(HasSubstr("1 part of the mock-up has no area on the lattice"),
                                         HasSubstr("'tool/tool.obj/tool'"))));
}

TEST_F(SceneLoad, UnusualSizesAndOpenToolsAreWarnedOf) {
  const auto large = load(R"({"mesh": "two.obj", "scale": 1000})", R"("mesh": "tool.obj")");
  ASSERT_TRUE(large) << large.error().sentence;
  EXPECT_THAT(large->scene.warnings, ElementsAre("the mock-up is 700 m long, over 100 m; check \"units\""));
  const auto small = load(R"({"mesh": "two.obj", "units": "mm"})", R"("mesh": "tool.obj", "units": "mm")");
  ASSERT_TRUE(small) << small.error().sentence;
  EXPECT_THAT(small->scene.warnings, ElementsAre("the mock-up is 0.0007 m long, under 1 mm; check \"units\"",
                                                 "the tool is 5e-05 m long, under 1 mm; check \"units\""));
  const auto open = load(R"({"mesh": "two.obj"})", R"("mesh": "open.obj")");
  ASSERT_TRUE(open) << open.error().sentence;
  EXPECT_THAT(open->scene.warnings, ElementsAre(testing::AllOf(HasSubstr("open.obj is open (3 open edges)"),
                                                               HasSubstr("centroid of its area"))));
  const auto told = load(R"({"mesh": "two.obj"})", R"("mesh": "open.obj", "centre_of_mass": [0, 0, 0])");
  ASSERT_TRUE(told) << told.error().sentence;
  EXPECT_THAT(told->scene.warnings, IsEmpty());
}

TEST_F(SceneLoad, CanBeCancelledAtAnyStep) {
  for (int allowed = 0; allowed < 4; ++allowed) {
    int calls = 0;
    const auto loaded = load(R"({"mesh": "two.obj"})", R"("mesh": "tool.obj")",
                             [&](const char*, double) { return calls++ < allowed; });
    ASSERT_FALSE(loaded) << allowed;
    EXPECT_THAT(loaded.error().sentence, HasSubstr("was cancelled"));
  }
}

}  // namespace
}  // namespace palpate

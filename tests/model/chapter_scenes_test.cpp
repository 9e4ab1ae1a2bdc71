// The chapter's two scenes, generated, loaded and asked of the CPU reference at the poses that their stages
// are about.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "cpu_ref/ref_backend.h"
#include "model/contact/response.h"
#include "model/files/path_file.h"
#include "model/generate/turn.h"
#include "model/scene/scene_file.h"
#include "temporary_folder.h"

namespace palpate {
namespace {

/// What a pose feels like.
struct Touch {
  int areas = 0;     ///< that give force
  double depth = 0;  ///< m, of the deepest
  Wrench wrench;
};

class ChapterScene {
 public:
  ChapterScene(const std::string& name, int triangles, int tool_triangles) {
    const TemporaryFolder folder;
    const auto source = [&](const std::string& body, int count) {
      return R"({"generate": {"name": ")" + name + R"(", "body": ")" + body + R"(", "triangles": )" +
             std::to_string(count) + "}}";
    };
    auto scene =
        read_scene(folder.write("s.json", R"({"static": [)" + source("mockup", triangles) + R"(], "tool": )" +
                                              source("tool", tool_triangles) + "}"));
    if (!scene) throw std::runtime_error(scene.error().sentence);
    auto loaded = load_scene(std::move(*scene), {});
    if (!loaded) throw std::runtime_error(loaded.error().sentence);
    loaded_ = std::move(*loaded);
    if (auto done = backend_->prepare(loaded_.geometry, Plan{}, {}); !done)
      throw std::runtime_error(done.error().sentence);
  }

  const LoadedScene& loaded() const { return loaded_; }

  Touch at(const Pose& pose) {
    const auto lattice_pose = to_lattice(pose, loaded_.geometry);
    Contacts contacts;
    if (auto done = backend_->query(*lattice_pose, nullptr, contacts); !done)
      throw std::runtime_error(done.error().sentence);
    ContactResponse response;
    respond(contacts, *lattice_pose, loaded_.geometry, Profile::kRefined, 2000, response);
    Touch touch;
    touch.wrench = response.wrench;
    for (const AreaResponse& area : response.areas) {
      touch.areas += area.depth > 0;
      touch.depth = std::max(touch.depth, area.depth);
    }
    return touch;
  }

  /// On the guide, turned by a rotation vector in its frame.
  Touch on_guide(double travel, const Vec3& turn) {
    return at(path_pose({0, {{travel, 0, 0}, rotation_about(turn)}, travel, 0}, loaded_.scene.device.guide));
  }

 private:
  LoadedScene loaded_;
  std::unique_ptr<CollisionBackend> backend_ = make_ref_backend();
};

struct Counts {
  const char* name;
  int triangles, tool_triangles;
};
const auto name_of = [](const auto& test_case) { return std::string(test_case.param.name); };

/// Which of x, y, z is largest.
int main_axis(const Vec3& v) {
  const Vec3 size = glm::abs(v);
  return size.x >= size.y && size.x >= size.z ? 0 : size.y >= size.z ? 1 : 2;
}

class ContactsScene : public testing::TestWithParam<Counts> {};

TEST_P(ContactsScene, ReachesTwoAndFourAreasAtOnceAndOneOnTheWay) {
  ChapterScene scene("contacts", GetParam().triangles, GetParam().tool_triangles);
  EXPECT_EQ(scene.loaded().geometry.mockup_report.collapsed + scene.loaded().geometry.tool_report.collapsed,
            0u);
  EXPECT_TRUE(scene.loaded().geometry.mockup.closed && scene.loaded().geometry.tool.closed);
  EXPECT_EQ(scene.loaded().scene.warnings, std::vector<std::string>{});
  EXPECT_EQ(scene.at(scene.loaded().scene.start).areas, 0);

  const double touching =
      -std::sqrt(0.038 * 0.038 - 0.027 * 0.027);  // pads of 8 mm at ±27 mm on a cylinder of 30 mm
  const auto pressed = [&](double height, double yaw) {
    return scene.at({{0, touching + 0.0015, height}, rotation_about({0, 0, 1}, yaw)});
  };
  EXPECT_EQ(pressed(0.160, 0).areas, 2);
  EXPECT_EQ(pressed(-0.040, 0).areas, 2);
  EXPECT_EQ(pressed(-0.040, 0.05).areas, 1);  // yawed, one end of the bar alone meets its edge
  EXPECT_EQ(pressed(0.060, 0).areas, 4);
  for (const double height : {0.160, -0.040, 0.060}) {
    const Touch touch = pressed(height, 0);
    EXPECT_LT(touch.wrench.force.y, -0.1);  // N: out of the obstacles, towards the hand; two small pads on a
                                            // cylinder press on little area
    EXPECT_EQ(main_axis(touch.wrench.force), 1);
    EXPECT_LT(touch.depth, 0.0015);  // m: no more than was pressed
  }
}

INSTANTIATE_TEST_SUITE_P(Sizes, ContactsScene,
                         testing::Values(Counts{"small", 4'000, 1'000}, Counts{"chapter", 25'000, 1'500}),
                         name_of);

class DisassemblyScene : public testing::TestWithParam<Counts> {};

TEST_P(DisassemblyScene, EachStageFeelsAsTheChapterSaysItDoes) {
  ChapterScene scene("disassembly", GetParam().triangles, GetParam().tool_triangles);
  EXPECT_EQ(scene.loaded().geometry.mockup_report.collapsed + scene.loaded().geometry.tool_report.collapsed,
            0u);
  EXPECT_TRUE(scene.loaded().geometry.mockup.closed && scene.loaded().geometry.tool.closed);
  EXPECT_EQ(scene.loaded().scene.warnings, std::vector<std::string>{});
  EXPECT_EQ(scene.at(scene.loaded().scene.start).areas, 0);  // 1

  const Touch obstacle = scene.on_guide(0.1835, {0.52, 0, 0});  // 2: a force along the pipe, backwards
  EXPECT_GE(obstacle.areas, 1);
  EXPECT_LT(obstacle.wrench.force.x, -0.5);
  EXPECT_EQ(main_axis(obstacle.wrench.force), 0);

  for (const double sign : {1.0, -1.0}) {  // 3: a torque about x, against the turn
    const Touch slot = scene.on_guide(0.206, {sign * 0.155, 0, 0});
    EXPECT_GE(slot.areas, 1);
    EXPECT_LT(sign * slot.wrench.torque.x, -0.02);
    EXPECT_EQ(main_axis(slot.wrench.torque), 0);
  }
  EXPECT_EQ(scene.on_guide(0.206, Vec3(0)).areas, 0);

  const Touch tilted = scene.on_guide(0.492, {0, 0, 0.36});  // 4: a torque about z, both sides of the pipe
  EXPECT_EQ(tilted.areas, 2);
  EXPECT_LT(tilted.wrench.torque.z, -0.02);
  EXPECT_EQ(main_axis(tilted.wrench.torque), 2);

  const Touch complex = scene.on_guide(0.632, {0.15, 0.34, -0.20});  // 5: on the pipe, about several axes
  EXPECT_GE(complex.areas, 1);
  const Vec3 torque = glm::abs(complex.wrench.torque);
  EXPECT_GT(
      std::min({std::max(torque.x, torque.y), std::max(torque.y, torque.z), std::max(torque.z, torque.x)}),
      0.005);  // N·m: two at least

  const PathPoint& last = scene.loaded().scene.device.path.back();  // 6
  EXPECT_EQ(last.stage, 6);
  EXPECT_EQ(scene.at(path_pose(last, scene.loaded().scene.device.guide)).areas, 0);
}

INSTANTIATE_TEST_SUITE_P(Sizes, DisassemblyScene,
                         testing::Values(Counts{"small", 5'000, 1'500}, Counts{"chapter", 100'000, 2'000}),
                         name_of);

}  // namespace
}  // namespace palpate

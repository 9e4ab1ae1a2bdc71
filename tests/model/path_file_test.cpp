#include "model/files/path_file.h"

#include <gtest/gtest.h>

#include <cmath>

#include "model/generate.h"
#include "model/scene/scene_file.h"
#include "temporary_folder.h"

namespace palpate {
namespace {

const std::string kFree = "time_s,x_m,y_m,z_m,qx,qy,qz,qw,stage\n";
const std::string kGuided = "time_s,travel_m,rx_rad,ry_rad,rz_rad,stage\n";
const std::string kGuide = "travel_m,x_m,y_m,z_m,qx,qy,qz,qw\n";

std::string path_fault(const std::string& text, bool guided = false) {
  const TemporaryFolder folder;
  const auto path = read_path(folder.write("p.csv", text), guided);
  return path ? "" : path.error().sentence.substr(folder.path("").size());
}

std::string guide_fault(const std::string& text) {
  const TemporaryFolder folder;
  const auto guide = read_guide(folder.write("g.csv", text));
  return guide ? "" : guide.error().sentence.substr(folder.path("").size());
}

TEST(PathFile, ABadLineIsNamedWithItsValueAndWhatIsAllowed) {
  EXPECT_EQ(path_fault(kFree + "0,0,0,0,0,0,0,1,1\r\n0.5,0,0,0,0,0,0,1,2\n"), "");
  EXPECT_EQ(path_fault("t,x\n"),
            "p.csv, line 1 is \"t,x\"; it must be \"" + kFree.substr(0, kFree.size() - 1) + "\"");
  EXPECT_EQ(path_fault("x,y,z,qx,qy,qz,qw\n0,0,0,0,0,0,1\n"),
            "p.csv, line 1 is \"x,y,z,qx,qy,qz,qw\"; it must be \"" + kFree.substr(0, kFree.size() - 1) +
                "\" (poses without times are for \"query\" and \"path\")");
  EXPECT_EQ(path_fault(kFree), "p.csv has no point");
  EXPECT_EQ(path_fault(kFree + "0,0,0,0,0,0,0,1\n"), "p.csv, line 2 has 8 values; the header has 9");
  EXPECT_EQ(path_fault(kFree + "+0,+0.5,0,0,0,0,0,+1,1\n"), "");
  EXPECT_EQ(path_fault(kFree + "0,+-1,0,0,0,0,0,1,1\n"), "p.csv, line 2: \"+-1\" is not a finite number");
  EXPECT_EQ(path_fault(kFree + "0,nan,0,0,0,0,0,1,1\n"), "p.csv, line 2: \"nan\" is not a finite number");
  EXPECT_EQ(path_fault(kFree + "0,1 m,0,0,0,0,0,1,1\n"), "p.csv, line 2: \"1 m\" is not a finite number");
  EXPECT_EQ(path_fault(kFree + "0,,0,0,0,0,0,1,1\n"), "p.csv, line 2: \"\" is not a finite number");
  EXPECT_EQ(path_fault(kFree + "1,0,0,0,0,0,0,1,1\n1,0,0,0,0,0,0,1,1\n"),
            "p.csv, line 3: time 1 s must be above the one before, 1 s");
  EXPECT_EQ(path_fault(kFree + "-1,0,0,0,0,0,0,1,1\n"),
            "p.csv, line 2: time -1 s is not from 0 to 1000000 s");
  EXPECT_EQ(path_fault(kFree + "0,0,0,0,0,0,0,0.5,1\n"),
            "p.csv, line 2: the rotation's length is 0.5; a unit quaternion has length 1");
  EXPECT_EQ(path_fault(kFree + "0,0,0,0,0,0,0,1,1.5\n"),
            "p.csv, line 2: stage 1.5 is not a whole number from 0 to 1000000");
  EXPECT_EQ(path_fault(kFree + "0,1e9,0,0,0,0,0,1,1\n"), "p.csv, line 2: position 1e+09 m is beyond 10000 m");
  EXPECT_EQ(path_fault(kGuided + "0,0,7,0,0,1\n", true),
            "p.csv, line 2: rotation 7 rad is beyond a whole turn");
  EXPECT_EQ(guide_fault(kGuide + "0,0,0,0,0,0,0,1\n"), "g.csv has fewer than two points; a guide is a curve");
  EXPECT_EQ(guide_fault(kGuide + "0,0,0,0,0,0,0,1\n0,1,0,0,0,0,0,1\n"),
            "g.csv, line 3: travel 0 m must be above the one before, 0 m");
}

TEST(PathFile, WhatIsWrittenReadsBackTheSame) {
  const TemporaryFolder folder;
  for (const std::string& name : generator_names()) {
    const auto scene = generate_scene(name, 1'000, 1'000);
    ASSERT_TRUE(scene);
    const bool guided = !scene->guide.empty();
    const auto path = read_path(folder.write("p.csv", path_text(scene->path, guided)), guided);
    ASSERT_TRUE(path) << path.error().sentence;
    ASSERT_EQ(path->size(), scene->path.size());
    for (std::size_t i = 0; i < path->size(); ++i) {
      const PathPoint &a = (*path)[i], &b = scene->path[i];
      EXPECT_EQ(a.time_s, b.time_s);
      EXPECT_EQ(a.stage, b.stage);
      EXPECT_EQ(a.travel_m, guided ? b.travel_m : 0);
      EXPECT_EQ(a.pose.position, b.pose.position);
      EXPECT_NEAR(std::abs(glm::dot(a.pose.rotation, b.pose.rotation)), 1,
                  1e-15);  // rounding of the rotation vector
    }
    if (!guided) continue;
    const auto guide = read_guide(folder.write("g.csv", guide_text(scene->guide)));
    ASSERT_TRUE(guide) << guide.error().sentence;
    for (std::size_t i = 0; i < guide->size(); ++i)
      EXPECT_EQ((*guide)[i].frame.position, scene->guide[i].frame.position);
  }
}

TEST(PathFile, AGuidedPointTurnsInTheGuidesFrame) {
  const double half = std::sqrt(0.5);
  const std::vector<GuidePoint> guide{{0, {{0, 0, 0}, Quat(half, 0, 0, half)}},
                                      {2, {{0, 4, 0}, Quat(half, 0, 0, half)}}};
  PathPoint point;
  point.travel_m = 0.5;
  point.pose.rotation = Quat(half, half, 0, 0);  // a quarter turn about the guide's x, which is the world's y
  const Pose pose = path_pose(point, guide);
  EXPECT_NEAR(pose.position.y, 1, 1e-15);
  const Vec3 z = pose.rotation * Vec3(0, 0, 1);  // its own −y, which is the world's +x
  EXPECT_NEAR(z.x, 1, 1e-15);
}

TEST(WriteGenerated, TheFilesReadBackAsTheSameScene) {
  const TemporaryFolder folder;
  const auto generated = generate_scene("disassembly", 1'000, 1'000);
  ASSERT_TRUE(generated);
  ASSERT_TRUE(write_generated(*generated, "disassembly", folder.path("made")));
  EXPECT_EQ(std::filesystem::file_size(folder.path("made/mockup.stl")),
            84 + 50 * generated->mockup.triangles.size());
  EXPECT_EQ(std::filesystem::file_size(folder.path("made/tool.stl")),
            84 + 50 * generated->tool.triangles.size());
  const auto scene = read_scene(folder.path("made/scene.json"));
  ASSERT_TRUE(scene) << scene.error().sentence;
  EXPECT_EQ(scene->device.path.size(), generated->path.size());
  EXPECT_EQ(scene->device.guide.size(), generated->guide.size());
  EXPECT_EQ(scene->device.actuated, generated->actuated);
  EXPECT_EQ(scene->stage_names, generated->stage_names);
}

TEST(WriteGenerated, AFolderThatCannotBeMadeIsABadValue) {
  const TemporaryFolder folder;
  folder.write("file", "");
  const auto generated = generate_scene("contacts", 1'000, 1'000);
  EXPECT_EQ(write_generated(*generated, "contacts", folder.path("file/x")).error().sentence,
            folder.path("file/x") + " is no directory and cannot be made one");
}

}  // namespace
}  // namespace palpate

#include "model/scene/scene_file.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "temporary_folder.h"

namespace palpate {
namespace {

using testing::HasSubstr;

/// The sentence of a scene file's error, the folder's name taken out; "" when it is read without one.
std::string fault_of(std::string_view text) {
  const TemporaryFolder folder;
  const auto scene = read_scene(folder.write("s.json", text));
  if (scene) return "";
  EXPECT_EQ(scene.error().code, ErrorCode::kBadValue);
  std::string sentence = scene.error().sentence;
  const std::string where = folder.path("");
  for (auto at = sentence.find(where); at != std::string::npos; at = sentence.find(where))
    sentence.erase(at, where.size());
  EXPECT_EQ(sentence.find('\n'), std::string::npos) << sentence;
  return sentence;
}

/// A scene that is right but for what is put into its tool and behind it.
std::string tool_with(const std::string& members, const std::string& behind = "") {
  return R"({"static": [{"mesh": "a.stl"}], "tool": {"mesh": "b.stl")" + members + "}" + behind + "}";
}
std::string scene_with(const std::string& behind) { return tool_with("", ", " + behind); }
std::string body_with(const std::string& members) {
  return R"({"static": [{"mesh": "a.stl", )" + members + R"(}], "tool": {"mesh": "b.stl"}})";
}

TEST(SceneFile, EverySettingArrivesInItsPlace) {
  const TemporaryFolder folder;
  folder.write("path.csv", "time_s,travel_m,rx_rad,ry_rad,rz_rad,stage\n0,0.5,0,0,0,1\n1,1,0,0,1,2\n");
  folder.write("guide.csv", "travel_m,x_m,y_m,z_m,qx,qy,qz,qw\n0,0,0,0,0,0,0,1\n1,2,0,0,0,0,0,1\n");
  const auto scene = read_scene(folder.write("s.json", R"({
    "static": [{"mesh": "engine.glb", "units": "mm", "without": ["Piston_1"], "position": [1, 2, 3], "rotation": [0, 0, 1, 0]},
               {"generate": {"name": "contacts", "triangles": 5000}}],
    "tool": {"mesh": "engine.glb", "scale": 0.5, "part": "Piston_1", "mass": 0.35, "centre_of_mass": [0, 0, 0.1]},
    "response": {"profile": "paper", "stiffness": 1500, "smooth_angle_deg": 45, "sample_spacing": 0.001, "voxel_size": "auto"},
    "start": "ignore_initial",
    "control": {"transitions": 5, "virtual_delay_ticks": 4, "watchdog_ms": 30, "fade_in_ms": 100, "coupling_n_per_m": 900, "coupling_nm_per_rad": 3},
    "device": {"driver": "simulated", "path": "path.csv", "guide": "guide.csv", "stages": ["one", "two"],
               "actuated": ["fx", "tz"], "mass": 1, "inertia": 0.01, "damping": 2, "angular_damping": 0.1,
               "hand": {"stiffness": 200, "damping": 7, "mass": 0.6, "angular_stiffness": 3, "angular_damping": 0.2},
               "max_force": 10, "max_torque": 1,
               "workspace": {"scale": 2, "offset": [1, 2, 3], "axes": ["y", "-x", "z"], "clutch_button": 3}}})"));
  ASSERT_TRUE(scene) << scene.error().sentence;
  ASSERT_EQ(scene->statics.size(), 2u);
  EXPECT_EQ(scene->statics[0].source.file,
            std::filesystem::weakly_canonical(folder.path("engine.glb")).string());
  EXPECT_EQ(scene->statics[0].source.scale, 1e-3);
  EXPECT_EQ(scene->statics[0].source.without, std::vector<std::string>{"Piston_1"});
  EXPECT_EQ(scene->statics[0].placement.position, Vec3(1, 2, 3));
  EXPECT_EQ(scene->statics[0].placement.rotation, Quat(0, 0, 0, 1));
  EXPECT_EQ(scene->statics[1].source.generate, "contacts/mockup");
  EXPECT_EQ(scene->statics[1].source.generate_parameters.at("triangles"), 5000);
  EXPECT_EQ(scene->tool.source.scale, 0.5);
  EXPECT_EQ(scene->tool.source.part, "Piston_1");
  EXPECT_EQ(scene->tool.mass_kg, 0.35);
  EXPECT_EQ(scene->tool.centre_of_mass_m, Vec3(0, 0, 0.1));
  EXPECT_EQ(scene->response.profile, Profile::kPaper);
  EXPECT_EQ(scene->response.stiffness_n_per_m, 1500);
  EXPECT_EQ(scene->response.smooth_angle_deg, 45);
  EXPECT_EQ(scene->response.sample_spacing_m, 0.001);
  EXPECT_FALSE(scene->response.voxel_size_m);
  EXPECT_EQ(scene->control.law, ForceLaw::kPrinted);
  EXPECT_EQ(scene->control.transitions, 5);
  EXPECT_EQ(scene->control.virtual_delay_ticks, 4);
  EXPECT_EQ(scene->control.watchdog_ms, 30);
  EXPECT_EQ(scene->control.fade_in_ms, 100);
  EXPECT_EQ(scene->control.coupling_n_per_m, 900);
  EXPECT_EQ(scene->start_contacts, StartContacts::kIgnoreInitial);
  EXPECT_EQ(scene->control.coupling_nm_per_rad, 3);
  const DeviceSettings& device = scene->device;
  EXPECT_EQ(device.actuated, (std::array<bool, 6>{true, false, false, false, false, true}));
  EXPECT_EQ(device.mass_kg, 1);
  EXPECT_EQ(device.inertia_kg_m2, 0.01);
  EXPECT_EQ(device.damping_n_s_per_m, 2);
  EXPECT_EQ(device.angular_damping_nm_s, 0.1);
  EXPECT_EQ(device.hand_stiffness_n_per_m, 200);
  EXPECT_EQ(device.hand_damping_n_s_per_m, 7);
  EXPECT_EQ(device.hand_mass_kg, 0.6);
  EXPECT_EQ(device.hand_angular_stiffness_nm, 3);
  EXPECT_EQ(device.hand_angular_damping_nm_s, 0.2);
  EXPECT_EQ(device.max_force_n, 10);
  EXPECT_EQ(device.max_torque_nm, 1);
  EXPECT_EQ(device.workspace.scale, 2);
  EXPECT_EQ(device.workspace.offset_m, Vec3(1, 2, 3));
  EXPECT_EQ(device.workspace.axes,
            (std::array<std::array<double, 3>, 3>{{{0, 1, 0}, {-1, 0, 0}, {0, 0, 1}}}));
  EXPECT_EQ(device.workspace.clutch_buttons, 4u);
  EXPECT_EQ(device.path.size(), 2u);
  EXPECT_EQ(device.guide.size(), 2u);
  EXPECT_EQ(scene->stage_names, (std::vector<std::string>{"one", "two"}));
  EXPECT_EQ(scene->start.position, Vec3(1, 0, 0));  // half way along the guide
}

TEST(SceneFile, TheLeastSceneHasTheDefaults) {
  EXPECT_EQ(fault_of(tool_with("")), "");
  const TemporaryFolder folder;
  const auto scene = read_scene(folder.write("s.json", tool_with("")));
  ASSERT_TRUE(scene);
  EXPECT_EQ(scene->control.law, ForceLaw::kCorrected);
  EXPECT_EQ(scene->statics[0].source.scale, 1);
  EXPECT_EQ(scene->start.position, Vec3(0));
  EXPECT_TRUE(scene->device.path.empty());
}

TEST(SceneFile, APartStartsWhereItsAssemblyIs) {
  const TemporaryFolder folder;
  const auto scene =
      read_scene(folder.write("s.json", R"({"static": [{"mesh": "other.stl", "position": [9, 9, 9]},
      {"mesh": "engine.glb", "without": ["Piston"], "position": [1, 2, 3], "rotation": [1, 0, 0, 0]}],
      "tool": {"mesh": "engine.glb", "part": "Piston"}})"));
  ASSERT_TRUE(scene);
  EXPECT_EQ(scene->start.position, Vec3(1, 2, 3));
  EXPECT_EQ(scene->start.rotation, Quat(0, 1, 0, 0));
}

TEST(SceneFile, AGeneratedToolBringsItsPathGuideStagesAndMotors) {
  const auto scene = read_scene(PALPATE_SCENES "/disassembly.json");
  ASSERT_TRUE(scene) << scene.error().sentence;
  EXPECT_FALSE(scene->device.path.empty());
  EXPECT_FALSE(scene->device.guide.empty());
  EXPECT_EQ(scene->stage_names.size(), 6u);
  EXPECT_EQ(scene->device.actuated, (std::array<bool, 6>{true, false, false, true, true, true}));
  EXPECT_NEAR(scene->start.position.x, 0.090, 1e-12);
}

TEST(SceneFile, AnUnknownKeyNamesItsPlaceAndTheNearestKnownOne) {
  EXPECT_EQ(fault_of(tool_with(R"(, "mas": 1)")),
            R"(s.json: /tool/mas is not a known key; the nearest is "mass")");
  EXPECT_EQ(fault_of(scene_with(R"("respons": {})")),
            R"(s.json: /respons is not a known key; the nearest is "response")");
  EXPECT_EQ(fault_of(scene_with(R"("device": {"hand": {"stifness": 1}})")),
            R"(s.json: /device/hand/stifness is not a known key; the nearest is "stiffness")");
  EXPECT_EQ(fault_of(body_with(R"("units ": "mm")")),
            R"(s.json: /static/0/units  is not a known key; the nearest is "units")");
  EXPECT_EQ(fault_of(body_with(R"("a/b\n": 1)")).substr(0, 48),
            R"(s.json: /static/0/a~1b\n is not a known key; the)");
}

TEST(SceneFile, AWrongTypeSaysWhatWasFoundAndWhatIsWanted) {
  EXPECT_EQ(fault_of(tool_with(R"(, "mass": "2 kg")")),
            R"(s.json: /tool/mass is a string ("2 kg"); a number is wanted)");
  EXPECT_EQ(fault_of(tool_with(R"(, "mass": null)")), "s.json: /tool/mass is null; a number is wanted");
  EXPECT_EQ(fault_of(tool_with(R"(, "part": 3)")), "s.json: /tool/part is a number (3); a string is wanted");
  EXPECT_EQ(fault_of(tool_with(R"(, "without": "x")")),
            R"(s.json: /tool/without has a string ("x"); an array of strings is wanted)");
  EXPECT_EQ(fault_of(scene_with(R"("response": [])")),
            "s.json: /response is an array ([]); an object is wanted");
  EXPECT_EQ(fault_of(body_with(R"("position": [0, 0])")),
            "s.json: /static/0/position is an array ([0,0]); three numbers [x, y, z] are wanted");
  EXPECT_EQ(fault_of("[]"), "s.json: the whole is an array ([]); an object is wanted");
}

TEST(SceneFile, AValueOutOfRangeSaysWhatIsAllowed) {
  EXPECT_EQ(fault_of(scene_with(R"("response": {"stiffness": -3})")),
            "s.json: /response/stiffness is -3; it must be from 0 to 1000000 N/m");
  EXPECT_EQ(fault_of(scene_with(R"("response": {"stiffness": 1000001})")),
            "s.json: /response/stiffness is 1000001; it must be from 0 to 1000000 N/m");
  EXPECT_EQ(fault_of(scene_with(R"("response": {"voxel_size": 0})")),
            "s.json: /response/voxel_size is 0; it must be above 0 and at most 100 m");
  EXPECT_EQ(fault_of(scene_with(R"("response": {"voxel_size": "automatic"})")),
            R"(s.json: /response/voxel_size is "automatic"; it must be "auto" or a number of metres)");
  EXPECT_EQ(fault_of(scene_with(R"("response": {"profile": "exact"})")),
            R"(s.json: /response/profile is "exact"; it must be "paper" or "refined")");
  EXPECT_EQ(fault_of(scene_with(R"("control": {"transitions": 0})")),
            "s.json: /control/transitions is 0; it must be a whole number from 1 to 1000");
  EXPECT_EQ(fault_of(scene_with(R"("control": {"transitions": 2.5})")),
            "s.json: /control/transitions is 2.5; it must be a whole number from 1 to 1000");
  EXPECT_EQ(fault_of(scene_with(R"("control": {"watchdog_ms": 0})")),
            "s.json: /control/watchdog_ms is 0; it must be above 0 and at most 10000 ms");
  EXPECT_EQ(fault_of(body_with(R"("units": "ft")")),
            R"(s.json: /static/0/units is "ft"; it must be "m", "mm", "cm" or "in")");
  EXPECT_EQ(
      fault_of(body_with(R"("rotation": [0, 0, 0, 2])")),
      "s.json: /static/0/rotation is [0,0,0,2], of length 2; a unit quaternion [x, y, z, w] has length 1");
  EXPECT_EQ(fault_of(scene_with(R"("device": {"actuated": ["fx", "rx"]})")),
            R"(s.json: /device/actuated has "rx"; each must be "fx", "fy", "fz", "tx", "ty" or "tz")");
  EXPECT_THAT(fault_of(tool_with(R"(, "mass": 1e999)")), HasSubstr("number overflow"));
}

TEST(SceneFile, WhatContradictsOrIsMissingIsRefused) {
  EXPECT_EQ(fault_of(R"({"tool": {"mesh": "b.stl"}})"),
            "s.json: /static is missing; an array of bodies is wanted");
  EXPECT_EQ(fault_of(R"({"static": [], "tool": {"mesh": "b.stl"}})"),
            "s.json: /static must be an array of at least one body");
  EXPECT_EQ(fault_of(R"({"static": [{"mesh": "a.stl"}]})"), "s.json: /tool is missing; an object is wanted");
  EXPECT_EQ(fault_of(R"({"static": [{}], "tool": {"mesh": "b.stl"}})"),
            R"(s.json: /static/0/mesh is missing, and so is "generate"; one is wanted)");
  EXPECT_EQ(fault_of(tool_with(R"(, "units": "m", "scale": 1)")),
            R"(s.json: /tool/units stands beside "scale"; only one of them may)");
  EXPECT_EQ(fault_of(body_with(R"("generate": {"name": "contacts"})")),
            R"(s.json: /static/0/mesh stands beside "generate"; only one of them may)");
  EXPECT_EQ(fault_of(R"({"static": [{"generate": {"name": "contact"}}], "tool": {"mesh": "b.stl"}})"),
            R"(s.json: /static/0/generate/name is "contact"; it must be "contacts" or "disassembly")");
  EXPECT_EQ(
      fault_of(
          R"({"static": [{"generate": {"name": "contacts", "triangles": 10}}], "tool": {"mesh": "b.stl"}})"),
      "s.json: /static/0/generate/triangles is 10; it must be a whole number from 1000 to 10000000");
  EXPECT_EQ(fault_of(scene_with(R"("device": {"workspace": {"axes": ["x", "y", "w"]}})")),
            R"(s.json: /device/workspace/axes has "w"; each must be "x", "-x", "y", "-y", "z" or "-z")");
  EXPECT_THAT(fault_of(scene_with(R"("device": {"workspace": {"axes": ["x", "y", "-z"]}})")),
              HasSubstr("right-handed"));
  EXPECT_THAT(fault_of(scene_with(R"("device": {"workspace": {"axes": ["x", "x", "z"]}})")),
              HasSubstr("once"));
  EXPECT_THAT(fault_of(scene_with(R"("device": {"workspace": {"axes": ["x", "y"]}})")),
              HasSubstr("three ways"));
  EXPECT_THAT(fault_of(scene_with(R"("device": {"workspace": {"scale": 0}})")),
              HasSubstr("/device/workspace/scale is 0; it must be above 0"));
  EXPECT_THAT(fault_of(scene_with(R"("device": {"workspace": {"clutch_button": 33}})")),
              HasSubstr("a whole number from 1 to 32"));
  EXPECT_THAT(fault_of(scene_with(R"("device": {"driver": "replay", "path": "t.csv", "guide": "g.csv"})")),
              HasSubstr("a replay needs none"));
  EXPECT_EQ(fault_of(scene_with(R"("device": {"guide": "g.csv"})")),
            R"(s.json: /device/guide needs "path" beside it, which says how to travel along it)");
  EXPECT_EQ(fault_of(scene_with(R"("device": {"path": "none.csv"})")), "none.csv cannot be opened");
}

TEST(SceneFile, SyntaxHasLineAndColumnAndAKeyStandsOnlyOnce) {
  EXPECT_THAT(fault_of("{\n  \"static\": [,]\n}"),
              HasSubstr("s.json: parse error at line 2, column 14: syntax error"));
  EXPECT_THAT(fault_of("{\"static\": NaN}"), HasSubstr("parse error at line 1, column 12"));
  EXPECT_THAT(fault_of(""), HasSubstr("parse error at line 1"));
  EXPECT_EQ(fault_of(std::string("{\0}", 3)), "s.json: byte 1 is zero: this is no text");
  EXPECT_THAT(fault_of("{\"static\": \"\xff\"}"), HasSubstr("invalid string: ill-formed UTF-8 byte"));
  EXPECT_THAT(fault_of("{\"\xc3(\": 1}"), HasSubstr("ill-formed UTF-8"));
  EXPECT_EQ(fault_of(R"({"static": [{"mesh": "a.stl"}, {"mesh": "a.stl", "mesh": "b.stl"}]})"),
            "s.json: /static/1/mesh stands there twice");
  // Deep nesting is no way to crash, neither the reader nor what prints or frees what was read.
  EXPECT_THAT(fault_of(std::string(100'000, '[')), HasSubstr("nests more than 64 deep"));
  EXPECT_THAT(fault_of("{\"static\":" + std::string(100'000, '[') + std::string(100'000, ']') + "}"),
              HasSubstr("nests more than 64 deep"));
}

TEST(SceneFile, AMissingFileAndADirectoryAreSaidToBe) {
  const TemporaryFolder folder;
  EXPECT_EQ(read_scene(folder.path("none.json")).error().sentence,
            folder.path("none.json") + " does not exist");
  EXPECT_EQ(read_scene(folder.path("")).error().sentence,
            folder.path("") + " is a directory; a scene is a JSON file");
}

}  // namespace
}  // namespace palpate

// A scene from the cache is the scene as its files make it, and any change of what it depends on is a change
// of the key.
#include "model/cache/geometry_cache.h"

#include <gmock/gmock.h>

#include "model/cache/archive.h"
#include "model/scene/scene_file.h"
#include "temporary_folder.h"

namespace palpate {
namespace {

constexpr const char* kTetrahedron =
    "OFF\n4 4 0\n0 0 0\n0.1 0 0\n0 0.1 0\n0 0 0.1\n3 0 2 1\n3 0 1 3\n3 1 2 3\n3 0 3 2\n";

class GeometryCache : public testing::Test {
 protected:
  GeometryCache() {
    folder.write("block.off", kTetrahedron);
    folder.write("tool.off", kTetrahedron);
  }
  Scene read(const std::string& more = "", const std::string& statics = R"({"mesh": "block.off"})",
             const std::string& tool = R"("mesh": "tool.off")") {
    auto scene = read_scene(
        folder.write("s.json", R"({"static": [)" + statics + R"(], "tool": {)" + tool + "}" + more + "}"));
    EXPECT_TRUE(scene) << (scene ? "" : scene.error().sentence);
    return std::move(*scene);
  }
  TemporaryFolder folder;
  DiskCache cache{DiskCache::Settings{folder.path("cache"), 1 << 20, 0}};
};

/// All that there is of a loaded scene's geometry, as bytes.
std::string bytes_of(const SceneGeometry& geometry) {
  KeyBuilder key;
  add_geometry(key, geometry);
  return key.finish().hex();
}

TEST_F(GeometryCache, AScenePreparedBeforeIsReadWithoutItsMeshesAndIsTheSame) {
  // An open tool in odd units, so that there are warnings and reports to keep.
  folder.write("open.off", "OFF\n3 1 0\n0 0 0\n1 0 0\n0 1 0\n3 0 1 2\n");
  const auto load = [&](DiskCache* with) {
    return load_scene(read("", R"({"mesh": "block.off"})", R"("mesh": "open.off", "scale": 0.0001)"), {}, {},
                      with);
  };
  const auto plain = load(nullptr), first = load(&cache), second = load(&cache);
  ASSERT_TRUE(plain && first && second);
  EXPECT_FALSE(plain->from_cache);
  EXPECT_FALSE(first->from_cache);
  EXPECT_TRUE(second->from_cache);
  EXPECT_EQ(bytes_of(second->geometry), bytes_of(plain->geometry));
  EXPECT_EQ(second->scene.warnings, plain->scene.warnings);
  EXPECT_GE(second->scene.warnings.size(), 2u);  // it is small, and open
  EXPECT_EQ(second->geometry.tool_report.notes, plain->geometry.tool_report.notes);
  EXPECT_EQ(second->geometry.tool_report.open_edges, 3u);
  ASSERT_EQ(second->geometry.mockup_report.parts.size(), 1u);
  EXPECT_TRUE(second->geometry.mockup_report.parts[0].closed);
  EXPECT_EQ(second->geometry.mockup_report.parts[0].box_max_m,
            plain->geometry.mockup_report.parts[0].box_max_m);
  EXPECT_THAT(cache.take_notes(), testing::IsEmpty());
}

TEST_F(GeometryCache, WhatThePressureFieldNeedsIsKept) {
  const auto load = [&](DiskCache* with) {
    return load_scene(read(R"(, "response": {"voxel_size": 0.1, "sample_spacing": 0.2})",
                           R"({"mesh": "block.off"}, {"mesh": "block.off", "position": [0.33, 0.17, 0.21]})"),
                      {}, {}, with);
  };
  const auto plain = load(nullptr), first = load(&cache), second = load(&cache);
  ASSERT_TRUE(plain && first && second);
  ASSERT_TRUE(second->from_cache);
  for (const auto mesh : {&SceneGeometry::mockup, &SceneGeometry::tool}) {
    const LatticeMesh &made = plain->geometry.*mesh, &found = second->geometry.*mesh;
    EXPECT_EQ(found.patch, made.patch);
    EXPECT_EQ(found.patch_count, made.patch_count);
    EXPECT_EQ(found.field_weight_q30, made.field_weight_q30);
    EXPECT_EQ(found.extra_samples, made.extra_samples);
  }
  EXPECT_EQ(plain->geometry.mockup.patch_count, 8u);
  EXPECT_FALSE(plain->geometry.mockup.extra_samples.empty());  // faces of an eighth of s²
  EXPECT_GT(plain->geometry.tool_gyration_m, 0);
  EXPECT_EQ(second->geometry.tool_gyration_m, plain->geometry.tool_gyration_m);
  EXPECT_EQ(second->geometry.reference_area_m2, plain->geometry.reference_area_m2);
}

TEST_F(GeometryCache, CoarseSamplesAreWarnedOfWhereverTheGeometryComesFrom) {
  const auto warnings = [&](const char* response, DiskCache* with) {
    auto loaded = load_scene(read(std::string(R"(, "response": )") + response), {}, {}, with);
    EXPECT_TRUE(loaded);
    std::erase_if(loaded->scene.warnings,
                  [](const std::string& warning) { return !warning.starts_with("samples are "); });
    return loaded->scene.warnings;
  };
  const char* coarse = R"({"voxel_size": 0.01, "sample_spacing": 0.02})";
  const auto told = testing::ElementsAre(
      "samples are 0.02 m apart, not less than a voxel (0.01 m): the force of a contact a few of them wide "
      "or deep is off by 5 % and more");
  EXPECT_THAT(warnings(coarse, nullptr), told);
  EXPECT_THAT(warnings(coarse, &cache), told);  // kept
  EXPECT_THAT(warnings(coarse, &cache), told);  // found
  EXPECT_THAT(warnings(R"({"voxel_size": 0.01, "sample_spacing": 0.02, "profile": "paper"})", &cache),
              testing::IsEmpty());  // the same geometry
  EXPECT_THAT(warnings(R"({"voxel_size": 0.01, "sample_spacing": 0.009})", &cache), testing::IsEmpty());
}

TEST_F(GeometryCache, EverythingThatShapesGeometryIsInTheKeyAndNothingElse) {
  const auto key = geometry_key(read());
  ASSERT_TRUE(key);
  EXPECT_EQ(geometry_key(read()), key);
  EXPECT_EQ(geometry_key(read(R"(, "response": {"stiffness": 77}, "control": {"watchdog_ms": 33})")), key);
  EXPECT_NE(geometry_key(read(R"(, "response": {"voxel_size": 0.005})")), key);
  EXPECT_NE(geometry_key(read(R"(, "response": {"sample_spacing": 0.001})")), key);
  EXPECT_NE(geometry_key(read(R"(, "response": {"smooth_angle_deg": 31})")), key);
  EXPECT_NE(geometry_key(read("", R"({"mesh": "block.off", "position": [0, 0, 1]})")), key);
  EXPECT_NE(geometry_key(read("", R"({"mesh": "block.off", "rotation": [0, 0, 1, 0]})")), key);
  EXPECT_NE(geometry_key(read("", R"({"mesh": "block.off", "units": "cm"})")), key);
  EXPECT_NE(geometry_key(read("", R"({"mesh": "block.off", "sheet_thickness": 0.001})")), key);
  EXPECT_NE(geometry_key(read("", R"({"mesh": "block.off"}, {"mesh": "block.off"})")), key);
  EXPECT_NE(geometry_key(read("", R"({"mesh": "tool.off"})")), key);  // warnings name the file
  EXPECT_NE(geometry_key(
                read("", R"({"mesh": "block.off"})", R"("mesh": "tool.off", "centre_of_mass": [0, 0, 0])")),
            key);
  folder.write("tool.off", std::string(kTetrahedron) + "#");
  EXPECT_NE(geometry_key(read()), key);
}

TEST_F(GeometryCache, AFileThatMayDrawOnOthersHasNoKey) {
  for (const char* name : {"a.obj", "a.gltf", "a.dae", "a"}) {
    folder.write(name, "anything");
    EXPECT_EQ(geometry_key(read("", std::string(R"({"mesh": ")") + name + "\"}")), std::nullopt) << name;
  }
  const auto glb = [&](const std::string& json) {
    std::string bytes = std::string("glTF\2\0\0\0\0\0\0\0", 12) + static_cast<char>(json.size()) +
                        std::string("\0\0\0JSON", 7) + json;
    folder.write("a.glb", bytes);
    return geometry_key(read("", R"({"mesh": "a.glb"})"));
  };
  EXPECT_TRUE(glb(R"({"buffers":[{"byteLength":4}]})"));
  EXPECT_FALSE(glb(R"({"buffers":[{"byteLength":4,"uri":"other.bin"}]})"));
  folder.write("a.glb", "glTF");
  EXPECT_FALSE(geometry_key(read("", R"({"mesh": "a.glb"})")));
  EXPECT_FALSE(geometry_key(read("", R"({"mesh": "missing.stl"})")));
}

TEST_F(GeometryCache, AnEntryThatHoldsSomethingElseIsDropped) {
  const auto key = *geometry_key(read());
  cache.keep("geometry", key, {"not a geometry"}, 1);
  EXPECT_FALSE(find_geometry(cache, key));
  EXPECT_THAT(cache.take_notes(), testing::ElementsAre(testing::HasSubstr("made anew")));
  const auto loaded = load_scene(read(), {}, {}, &cache);
  ASSERT_TRUE(loaded);
  EXPECT_FALSE(loaded->from_cache);
}

}  // namespace
}  // namespace palpate

// scenes/scene.schema.json and the reader of scene files must know the same keys, and every scene of ours
// must keep to both.
#include <gtest/gtest.h>

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <nlohmann/json.hpp>
#include <valijson/adapters/nlohmann_json_adapter.hpp>
#include <valijson/schema.hpp>
#include <valijson/schema_parser.hpp>
#include <valijson/validator.hpp>

#include "model/scene/scene_file.h"
#include "model/scene/scene_keys.h"

namespace palpate {
namespace {

using nlohmann::json;

json load(const std::filesystem::path& path) {
  std::ifstream in(path);
  return json::parse(in);
}

class Schema : public testing::Test {
 protected:
  void SetUp() override {
    text_ = load(std::filesystem::path(PALPATE_SCENES) / "scene.schema.json");
    valijson::SchemaParser parser;
    parser.populateSchema(valijson::adapters::NlohmannJsonAdapter(text_), schema_);
  }

  bool accepts(const json& scene) {
    valijson::Validator validator;
    return validator.validate(schema_, valijson::adapters::NlohmannJsonAdapter(scene), nullptr);
  }

  json text_;
  valijson::Schema schema_;
};

TEST_F(Schema, KnowsTheKeysThatTheReaderKnowsAndNoOthers) {
  for (const auto& [object, keys] : scene_keys()) {
    const json& described = object == "scene" ? text_ : text_.at("definitions").at(object);
    EXPECT_EQ(described.at("additionalProperties"), false) << object;
    std::vector<std::string> wanted = keys, found;
    for (const auto& [key, ignored] : described.at("properties").items()) found.push_back(key);
    std::sort(wanted.begin(), wanted.end());
    EXPECT_EQ(found, wanted) << object;
  }
  for (const auto& [name, definition] : text_.at("definitions").items())
    EXPECT_EQ(definition.contains("properties"), scene_keys().contains(name)) << name;
}

TEST_F(Schema, EveryKeyIsDescribed) {
  for (const auto& [object, keys] : scene_keys()) {
    const json& described = object == "scene" ? text_ : text_.at("definitions").at(object);
    for (const auto& [key, value] : described.at("properties").items()) {
      const bool elsewhere =
          value.contains("$ref") &&
          text_.at("definitions").at(value.at("$ref").get<std::string>().substr(14)).contains("description");
      EXPECT_TRUE(elsewhere || value.contains("description")) << object << "/" << key;
    }
  }
}

TEST_F(Schema, EverySceneOfOursKeepsToItAndIsRead) {
  int scenes = 0;
  for (const auto& entry : std::filesystem::recursive_directory_iterator(PALPATE_SCENES)) {
    if (entry.path().extension() != ".json" || entry.path().filename() == "scene.schema.json") continue;
    ++scenes;
    EXPECT_TRUE(accepts(load(entry.path()))) << entry.path();
    const auto read = read_scene(entry.path().string());
    EXPECT_TRUE(read) << read.error().sentence;
  }
  EXPECT_GE(scenes, 2);
}

TEST_F(Schema, RefusesWhatTheReaderRefuses) {
  const json good =
      json::parse(R"({"static": [{"mesh": "a.stl"}], "tool": {"mesh": "b.stl", "centre_of_mass": "auto"}})");
  EXPECT_TRUE(accepts(good));
  for (const char* patch :
       {R"({"tool": {"mas": 1}})", R"({"tool": {"mass": 0}})", R"({"tool": {"mass": "1"}})",
        R"({"tool": {"units": "m", "scale": 1}})", R"({"tool": {"units": "ft"}})",
        R"({"tool": {"generate": {"name": "contacts"}}})", R"({"tool": null})", R"({"static": []})",
        R"({"static": [{"mesh": "a.stl", "rotation": [0, 0, 1]}]})", R"({"response": {"stiffness": -1}})",
        R"({"response": {"voxel_size": 0}})", R"({"response": {"profile": "exact"}})",
        R"({"control": {"transitions": 0}})", R"({"device": {"guide": "g.csv"}})",
        R"({"device": {"actuated": ["rx"]}})", R"({"device": {"workspace": {"axes": ["x", "y"]}}})",
        R"({"device": {"workspace": {"scale": 0}}})", R"({"device": {"workspace": {"clutch_button": 0}}})",
        R"({"device": {"hand": {"mass": -1}}})"}) {
    json bad = good;
    bad.merge_patch(json::parse(patch));
    EXPECT_FALSE(accepts(bad)) << patch;
  }
}

}  // namespace
}  // namespace palpate

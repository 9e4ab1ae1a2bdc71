#include "service/server/scene_content.h"

#include <algorithm>
#include <fstream>
#include <iterator>
#include <set>

#include "service/server/content_hash.h"
#include "service/server/json_input.h"
#include "service/server/safe_path.h"

namespace palpate {
namespace {

namespace fs = std::filesystem;

/// The values of a scene file that are read as paths.
std::set<std::string> named_files(const nlohmann::json& scene) {
  std::set<std::string> names;
  const auto take = [&](const nlohmann::json& object, const char* key) {
    if (object.is_object() && object.contains(key) && object[key].is_string()) names.insert(object[key].get<std::string>());
  };
  if (scene.contains("static") && scene["static"].is_array())
    for (const nlohmann::json& body : scene["static"]) take(body, "mesh");
  if (scene.contains("tool")) take(scene["tool"], "mesh");
  if (scene.contains("device")) {
    take(scene["device"], "path");
    take(scene["device"], "guide");
  }
  return names;
}

}  // namespace

std::variant<SceneContent, Problem> read_scene_content(const fs::path& file, const fs::path& folder, std::optional<Profile> profile, const ServerLimits& limits) {
  std::error_code error;
  if (fs::file_size(file, error) > limits.json_bytes || error)
    return Problem{413, "too-large", "the scene file is larger than " + std::to_string(limits.json_bytes) + " bytes, or no file", "scene"};
  std::ifstream in(file, std::ios::binary);
  const std::string text((std::istreambuf_iterator<char>(in)), std::istreambuf_iterator<char>());
  const auto scene = read_json_object(text, limits.json_depth);
  if (const auto* problem = std::get_if<Problem>(&scene)) return Problem{400, "bad-value", problem->detail, "scene"};

  ContentHash hash;
  hash.add("palpate scene 1\n");
  hash.add(profile ? (*profile == Profile::kPaper ? "paper\n" : "refined\n") : "as written\n");
  hash.add(text);
  for (const std::string& name : named_files(std::get<nlohmann::json>(scene))) {
    if (name.find('\0') != std::string::npos) return bad_request("a file's name holds a zero byte", "scene");
    const fs::path wanted = file.parent_path() / name;
    const auto real = path_below(folder, wanted);
    if (!real) {
      // Whether something is there outside is nobody's business: a name that leads out is refused alike.
      const fs::path straight = wanted.lexically_normal();
      const bool inside = std::mismatch(folder.begin(), folder.end(), straight.begin(), straight.end()).first == folder.end();
      if (inside && !fs::exists(fs::symlink_status(straight, error))) return bad_request("the scene names \"" + shown_text(name) + "\", and there is no such file", "scene");
      return Problem{403, "outside-root", "the scene names \"" + shown_text(name) + "\", which lies outside the folder that may be read", "scene"};
    }
    if (!fs::is_regular_file(*real, error)) return bad_request("the scene names \"" + shown_text(name) + "\", which is no file", "scene");
    const std::string content = file_hash(real->string());
    if (content.empty()) return Problem{500, "internal", "reading \"" + shown_text(name) + "\" failed", "scene"};
    hash.add(std::string("\n") + std::to_string(name.size()) + " " + name + " " + content);
  }
  SceneContent out;
  out.id = hash.hex().substr(0, 32);
  out.file = file;
  out.folder = folder;
  out.profile = profile;
  return out;
}

}  // namespace palpate

#include "service/server/scenes/scene_content.h"

#include <algorithm>
#include <array>
#include <fstream>
#include <iterator>
#include <map>
#include <set>

#include "model/cache/geometry_cache.h"
#include "model/scene/scene_file.h"
#include "service/server/http/json_input.h"
#include "service/server/http/safe_path.h"
#include "service/server/scenes/content_hash.h"

namespace palpate {
namespace {

namespace fs = std::filesystem;

/// The values of a scene file that are read as paths.
std::set<std::string> named_files(const nlohmann::json& scene) {
  std::set<std::string> names;
  const auto take = [&](const nlohmann::json& object, const char* key) {
    if (object.is_object() && object.contains(key) && object[key].is_string())
      names.insert(object[key].get<std::string>());
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

constexpr std::size_t kMostNeighbours = 4096;  ///< chosen

/// What may stand beside a mesh that draws on other files (a glTF's buffers): which of them does, only its
/// reader knows. Names, sizes and times of change stand for the files; what sessions record is none of it.
/// False: there are too many.
bool add_neighbours(ContentHash& hash, const fs::path& mesh) {
  std::error_code error;
  std::map<std::string, std::string> files;
  const fs::path folder = mesh.parent_path();
  for (auto it =
           fs::recursive_directory_iterator(folder, fs::directory_options::skip_permission_denied, error);
       !error && it != fs::recursive_directory_iterator(); it.increment(error)) {
    const std::string name = it->path().filename().string();
    if (!it->is_regular_file(error) || name == "frames.jsonl" || name == "trace.csv" ||
        name == "summary.json" || name == "report.html")
      continue;
    if (files.size() == kMostNeighbours) return false;
    files[it->path().lexically_relative(folder).string()] =
        std::to_string(it->file_size(error)) + " " +
        std::to_string(it->last_write_time(error).time_since_epoch().count());
  }
  for (const auto& [name, state] : files)
    hash.add("\n+" + std::to_string(name.size()) + " " + name + " " + state);
  return true;
}

}  // namespace

std::optional<Problem> choose_engine(const nlohmann::json& wanted, SceneContent& content) {
  constexpr std::array kEngines = {"auto", "gpu", "cpu", "ref"};
  if (!wanted.is_string() || std::find(kEngines.begin(), kEngines.end(), wanted) == kEngines.end())
    return bad_request("\"engine\" is auto, gpu, cpu or ref", "engine");
  content.engine = wanted.get<std::string>();
  ContentHash hash;
  hash.add("palpate scene 1, engine " + content.engine + "\n" + content.id);
  content.id = hash.hex().substr(0, 32);
  return std::nullopt;
}

std::variant<SceneContent, Problem> read_scene_content(const fs::path& file, const fs::path& folder,
                                                       std::optional<Profile> profile,
                                                       const ServerLimits& limits, Neighbours neighbours) {
  std::error_code error;
  if (fs::file_size(file, error) > limits.json_bytes || error)
    return Problem{
        413, "too-large",
        "the scene file is larger than " + std::to_string(limits.json_bytes) + " bytes, or no file", "scene"};
  std::ifstream in(file, std::ios::binary);
  const std::string text((std::istreambuf_iterator<char>(in)), std::istreambuf_iterator<char>());
  const auto scene = read_json_object(text, limits.json_depth, {}, "scene file");
  if (const auto* problem = std::get_if<Problem>(&scene))
    return Problem{400, "bad-value", problem->detail, "scene"};

  ContentHash hash;
  hash.add("palpate scene 1\n");
  hash.add(profile ? (*profile == Profile::kPaper ? "paper\n" : "refined\n") : "as written\n");
  hash.add(text);
  std::set<std::string> names = named_files(std::get<nlohmann::json>(scene));
  if (neighbours == Neighbours::kByContent)
    for (const fs::directory_entry& entry : fs::directory_iterator(folder, error))
      if (entry.is_regular_file(error) && entry.path() != file)
        names.insert(entry.path().filename().string());
  for (const std::string& name : names) {
    if (name.find('\0') != std::string::npos) return bad_request("a file's name holds a zero byte", "scene");
    const fs::path wanted = file.parent_path() / name;
    const auto real = path_below(folder, wanted);
    if (!real) {
      // Whether something is there outside is nobody's business: a name that leads out is refused alike.
      const fs::path straight = wanted.lexically_normal();
      const bool inside =
          std::mismatch(folder.begin(), folder.end(), straight.begin(), straight.end()).first == folder.end();
      if (inside && !fs::exists(fs::symlink_status(straight, error)))
        return bad_request("the scene names \"" + shown_text(name) + "\", and there is no such file",
                           "scene");
      return Problem{
          403, "outside-root",
          "the scene names \"" + shown_text(name) + "\", which lies outside the folder that may be read",
          "scene"};
    }
    if (!fs::is_regular_file(*real, error))
      return bad_request("the scene names \"" + shown_text(name) + "\", which is no file", "scene");
    const std::string content = file_hash(real->string());
    if (content.empty())
      return Problem{500, "internal", "reading \"" + shown_text(name) + "\" failed", "scene"};
    hash.add(std::string("\n") + std::to_string(name.size()) + " " + name + " " + content);
    if (neighbours == Neighbours::kByTime && !stands_alone(real->string()) && !name.ends_with(".csv") &&
        !add_neighbours(hash, *real))
      return bad_request("\"" + shown_text(name) +
                             "\" may draw on the files beside it, and there are more than " +
                             std::to_string(kMostNeighbours) + " of them",
                         "scene");
  }
  // What preparation would say of the scene file is said at once.
  if (const auto readable = read_scene(file.string(), profile); !readable)
    return bad_request(without_folder(readable.error().sentence, folder), "scene");
  SceneContent out;
  out.id = hash.hex().substr(0, 32);
  out.file = file;
  out.folder = folder;
  out.profile = profile;
  return out;
}

}  // namespace palpate

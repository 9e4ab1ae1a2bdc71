#include "service/server/assemblies/assembly_scene.h"

#include <algorithm>
#include <set>

#include "model/cache/geometry_cache.h"
#include "model/scene/scene_file.h"
#include "service/server/http/json_input.h"
#include "service/server/http/safe_path.h"

namespace palpate {
namespace {

namespace fs = std::filesystem;

/// Names of meshes that the scene has; a path of a device is `path.csv` alone.
std::variant<std::set<std::string>, Problem> named_meshes(const Assembly& assembly,
                                                          const nlohmann::json& scene, bool with_path) {
  std::set<std::string> names;
  std::optional<Problem> problem;
  const auto take = [&](const nlohmann::json& body, const std::string& where) {
    if (!body.is_object() || !body.contains("mesh") || !body["mesh"].is_string()) {
      problem = bad_request("\"" + where + "\" has no \"mesh\"", "scene");
      return;
    }
    const std::string name = body["mesh"];
    if (std::none_of(assembly.files.begin(), assembly.files.end(),
                     [&](const AssemblyFile& file) { return file.mesh && file.name == name; }))
      problem = bad_request("the scene names \"" + shown_text(name) + "\", which is no mesh of the assembly",
                            "scene");
    names.insert(name);
  };
  if (!scene.is_object() || !scene.contains("tool") || !scene.contains("static") ||
      !scene["static"].is_array())
    return bad_request("\"scene\" is an object with \"static\", a list, and \"tool\"", "scene");
  for (const nlohmann::json& body : scene["static"]) take(body, "static");
  take(scene["tool"], "tool");
  if (scene.contains("device") && scene["device"].is_object())
    for (const char* key : {"path", "guide"})
      if (scene["device"].contains(key) &&
          !(with_path && std::string(key) == "path" && scene["device"][key] == "path.csv"))
        problem = bad_request(
            std::string("\"device\" may have \"path\": \"path.csv\" where \"path\" is sent; its \"") + key +
                "\" is another",
            "scene");
  if (problem) return *problem;
  return names;
}

}  // namespace

std::variant<std::uint64_t, Problem> write_assembly_scene(const Assembly& assembly,
                                                          const nlohmann::json& scene,
                                                          const std::string& path, const fs::path& folder,
                                                          bool linked) {
  const auto named = named_meshes(assembly, scene, !path.empty());
  if (const auto* problem = std::get_if<Problem>(&named)) return *problem;
  const auto& names = std::get<std::set<std::string>>(named);
  // Which company a mesh keeps only its reader knows: one that stands alone keeps none.
  const bool company = std::any_of(names.begin(), names.end(), [&](const std::string& name) {
    return !stands_alone((assembly.folder->path() / name).string());
  });
  // The reader judges the scene where it will lie, and before any mesh is there.
  const std::string text = scene.dump(2, ' ', false, nlohmann::json::error_handler_t::replace) + "\n";
  if (auto problem = write_new_file(folder / "scene.json", text)) return *problem;
  if (!path.empty())
    if (auto problem = write_new_file(folder / "path.csv", path)) return *problem;
  if (const auto readable = read_scene((folder / "scene.json").string()); !readable) {
    const std::string sentence = without_folder(readable.error().sentence, folder);
    return bad_request(sentence, sentence.starts_with("path.csv") ? "path" : "scene");
  }
  std::uint64_t bytes = 0;
  for (const AssemblyFile& file : assembly.files) {
    if (!names.contains(file.name) && !(company && !file.mesh)) continue;
    std::error_code error = std::make_error_code(std::errc::not_supported);
    if (linked) fs::create_hard_link(assembly.folder->path() / file.name, folder / file.name, error);
    if (error) fs::copy_file(assembly.folder->path() / file.name, folder / file.name, error);
    if (error) return Problem{507, "storage", "the scene can't be stored: " + error.message(), ""};
    bytes += file.bytes;
  }
  return bytes + text.size() + path.size();
}

}  // namespace palpate

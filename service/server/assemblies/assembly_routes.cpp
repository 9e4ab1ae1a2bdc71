#include "service/server/assemblies/assembly_routes.h"

#include <charconv>

#include "service/server/assemblies/assembly_scene.h"
#include "service/server/assemblies/assembly_upload.h"
#include "service/server/http/json_input.h"
#include "service/server/http/safe_path.h"
#include "service/server/scenes/drawing.h"
#include "service/server/scenes/scene_content.h"

namespace palpate {
namespace {

namespace fs = std::filesystem;

constexpr std::size_t kMostDrawn = 2'000'000;  ///< triangles of one answer; chosen
constexpr std::size_t kPathBytes = 8 << 20;    ///< of a scene with a recorded path

template <class T>
void put(std::string& out, const T& value) {
  out.append(reinterpret_cast<const char*>(&value), sizeof value);
}

/// `PGEO` of docs/SERVICE.md with all triangles as the static body, in file units, and no tool.
std::string geometry_bytes(const Mesh& mesh, std::size_t most) {
  std::optional<DrawnMesh> drawn;
  if (mesh.triangles.size() > most) drawn = reduced(mesh, most);
  const auto& vertices = drawn ? drawn->vertices : mesh.vertices;
  const auto& triangles = drawn ? drawn->triangles : mesh.triangles;
  std::string out = "PGEO";
  out.reserve(32 + 12 * vertices.size() + 16 * triangles.size());
  put(out, std::uint32_t{1});
  put(out, std::uint32_t{drawn ? 1u : 0u});
  put(out, static_cast<std::uint32_t>(vertices.size()));
  put(out, static_cast<std::uint32_t>(triangles.size()));
  for (int i = 0; i < 3; ++i) put(out, std::uint32_t{0});
  for (const Vec3& vertex : vertices)
    for (int k = 0; k < 3; ++k) put(out, static_cast<float>(vertex[k]));
  for (const auto& triangle : triangles) put(out, triangle);
  for (std::size_t i = 0; i < triangles.size(); ++i)
    put(out, drawn ? drawn->ids[i] : static_cast<std::uint32_t>(i));
  return out;
}

HttpResponse geometry(const AssemblyStore& assemblies, const HttpRequest& request) {
  const std::string text = request.query_or("max_triangles", "400000");
  std::size_t most = 0;
  const auto [stop, error] = std::from_chars(text.data(), text.data() + text.size(), most);
  if (error != std::errc() || stop != text.data() + text.size() || most < 100 || most > kMostDrawn)
    return bad_request("max_triangles is '" + shown_text(text) + "', allowed is 100 to 2000000",
                       "max_triangles");
  const auto found = assemblies.ready(request.segments[2]);
  if (const auto* problem = std::get_if<Problem>(&found)) return *problem;
  HttpResponse response(200, geometry_bytes(std::get<0>(found)->mesh, most));
  response.type = "application/octet-stream";
  return response;
}

/// {"scene": {…}, "path": "time_s,x_m,…"}, with `folder` where it is to be saved, `name` and `engine` else.
std::variant<nlohmann::json, Problem> read_order(const std::string& body, const ServerLimits& limits,
                                                 bool save) {
  std::vector<std::string> keys = {"scene", "path"};
  for (const char* key :
       save ? std::vector<const char*>{"folder"} : std::vector<const char*>{"name", "engine"})
    keys.emplace_back(key);
  auto read = read_json_object(body, limits.json_depth, keys);
  if (std::holds_alternative<Problem>(read)) return read;
  const auto& json = std::get<nlohmann::json>(read);
  if (!json.contains("scene") || !json["scene"].is_object())
    return bad_request("\"scene\" is wanted: a scene file's object", "scene");
  for (const char* key : {"path", "folder", "name"})
    if (json.contains(key) && !json[key].is_string())
      return bad_request(std::string("\"") + key + "\" is no text", key);
  return read;
}

std::string text_of(const nlohmann::json& order, const char* key) {
  return order.contains(key) ? order[key].get<std::string>() : std::string();
}

/// A scene of the assembly, prepared as an upload is.
HttpResponse make_scene(const Assembly& assembly, const nlohmann::json& order, SceneStore& store,
                        const ServerLimits& limits, const fs::path& spool) {
  static std::atomic<std::uint64_t> count{0};
  std::error_code error;
  SpoolFolder folder(spool / ("made-" + std::to_string(++count)));
  if (!fs::create_directory(folder.path(), error))
    return Problem{507, "storage", "the scene can't be stored: " + error.message(), ""};
  const auto bytes =
      write_assembly_scene(assembly, order["scene"], text_of(order, "path"), folder.path(), true);
  if (const auto* problem = std::get_if<Problem>(&bytes)) return *problem;
  auto content = read_scene_content(folder.path() / "scene.json", folder.path(), std::nullopt, limits,
                                    Neighbours::kByContent);
  if (const auto* problem = std::get_if<Problem>(&content)) return *problem;
  auto& made = std::get<SceneContent>(content);
  const std::string name = shown_text(text_of(order, "name"));
  made.name = name.empty() ? assembly.files.front().name : name;
  made.uploaded = true;
  made.disk_bytes = std::get<std::uint64_t>(bytes);
  if (order.contains("engine"))
    if (auto problem = choose_engine(order["engine"], made)) return *problem;
  const std::string id = made.id;
  folder.take();
  auto answer = store.add(std::move(made));
  if (const auto* problem = std::get_if<Problem>(&answer)) return *problem;
  const auto& view = std::get<SceneStore::View>(answer);
  HttpResponse response(view.state == SceneState::kReady ? 200 : 202, view.json);
  response.headers.emplace_back("Location", "/v1/scenes/" + id);
  return response;
}

/// The scene and its meshes in a new folder below the root.
HttpResponse save_scene(const Assembly& assembly, const nlohmann::json& order, const fs::path& root) {
  const std::string name = text_of(order, "folder");
  if (!plain_name(name))
    return bad_request(
        "the folder '" + shown_text(name) +
            "' is not letters, digits, '.', '_', '-' only, at most 100, without a dot in front",
        "folder");
  if (root.empty())
    return Problem{404, "not-found", "this server has no folder of scenes (see --root)", "folder"};
  std::error_code error;
  if (!fs::create_directory(root / name, error)) {
    if (error) return Problem{507, "storage", "the folder can't be made: " + error.message(), "folder"};
    return Problem{409, "conflict", "there is something of the name '" + name + "' already", "folder"};
  }
  SpoolFolder folder(root / name);  // goes again when something goes wrong
  const auto bytes =
      write_assembly_scene(assembly, order["scene"], text_of(order, "path"), folder.path(), false);
  if (const auto* problem = std::get_if<Problem>(&bytes)) return *problem;
  folder.take();
  return {201, dump({{"path", name + "/scene.json"}, {"bytes", std::get<std::uint64_t>(bytes)}})};
}

}  // namespace

void add_assembly_routes(Router& router, AssemblyStore& assemblies, SceneStore& store, WorkerPool& workers,
                         Metrics& metrics, const ServerLimits& limits, const fs::path& root,
                         const fs::path& spool) {
  router.add({.method = "POST",
              .pattern = "v1/assemblies",
              .body_limit = limits.json_bytes,
              .handle =
                  [](const HttpRequest& request, const Reply& reply) {
                    reply(Problem{415, "media-type",
                                  "an assembly comes as multipart/form-data, not as '" +
                                      shown_text(request.content_type) + "'",
                                  "Content-Type"});
                  },
              .sink_type = "multipart/form-data",
              .sink_limit = limits.upload_bytes,
              .sink =
                  [&assemblies, &metrics, &limits, spool](const HttpRequest& request) {
                    return receive_assembly(
                        request, spool, limits, metrics,
                        [&assemblies](std::shared_ptr<SpoolFolder> folder, std::vector<AssemblyFile> files,
                                      const Reply& reply) {
                          reply(HttpResponse(202, assemblies.add(std::move(folder), std::move(files))));
                        });
                  }});
  router.add(
      {.method = "GET",
       .pattern = "v1/assemblies/*",
       .handle = [&assemblies](const HttpRequest& request, const Reply& reply) {
         const auto json = assemblies.json(request.segments[2]);
         reply(json ? HttpResponse(200, *json)
                    : HttpResponse(Problem{404, "not-found",
                                           "there is no assembly " + shown_text(request.segments[2]), "id"}));
       }});
  router.add({.method = "DELETE",
              .pattern = "v1/assemblies/*",
              .handle = [&assemblies, &workers](const HttpRequest& request, const Reply& reply) {
                workers.post([&assemblies, id = request.segments[2], reply] {
                  reply(assemblies.remove(id)
                            ? HttpResponse(204, "")
                            : HttpResponse(
                                  Problem{404, "not-found", "there is no assembly " + shown_text(id), "id"}));
                });
              }});
  router.add({.method = "GET",
              .pattern = "v1/assemblies/*/geometry",
              .parameters = {"max_triangles"},
              .handle = [&assemblies, &workers](HttpRequest request, const Reply& reply) {
                workers.post([&assemblies, request = std::move(request), reply] {
                  reply(geometry(assemblies, request));
                });
              }});
  for (const bool save : {false, true})
    router.add({.method = "POST",
                .pattern = save ? "v1/assemblies/*/save" : "v1/assemblies/*/scene",
                .body_limit = kPathBytes,
                .handle = [&assemblies, &store, &workers, &limits, root, spool, save](HttpRequest request,
                                                                                      const Reply& reply) {
                  workers.post(
                      [&assemblies, &store, &limits, root, spool, save, request = std::move(request), reply] {
                        const auto found = assemblies.ready(request.segments[2]);
                        if (const auto* problem = std::get_if<Problem>(&found)) return reply(*problem);
                        const auto order = read_order(request.body, limits, save);
                        if (const auto* problem = std::get_if<Problem>(&order)) return reply(*problem);
                        const Assembly& assembly = *std::get<0>(found);
                        const auto& json = std::get<nlohmann::json>(order);
                        reply(save ? save_scene(assembly, json, root)
                                   : make_scene(assembly, json, store, limits, spool));
                      });
                }});
}

}  // namespace palpate

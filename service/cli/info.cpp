#include <fmt/format.h>

#include <algorithm>
#include <cstdio>
#include <nlohmann/json.hpp>

#include "model/geometry_build.h"
#include "model/mesh_import.h"
#include "service/cli/cli.h"
#include "service/cli/console.h"
#include "service/cli/numbers.h"
#include "service/cli/scene_host.h"
#include "service/scene_talk.h"

namespace palpate {
namespace {

struct MeshInfo {
  ImportReport import;
  MeshReport body;
  bool closed = false;
  double step = 0;       ///< of the lattice on which it was looked at, file units
  Vec3 min{0}, max{0};   ///< of the vertices that triangles use, file units
};

/// Import as it stands in the file (scale 1: one file unit is taken for a metre), then what a mock-up would go through.
Result<MeshInfo> inspect(const std::string& path, const ImportLimits& limits) {
  MeshInfo info;
  const Result<Mesh> mesh = import_mesh(path, 1.0, info.import, limits);
  if (!mesh) return mesh.error();
  bool first = true;
  for (const auto& triangle : mesh->triangles)
    for (const std::uint32_t vertex : triangle) {
      const Vec3& point = mesh->vertices[vertex];
      info.min = first ? point : glm::min(info.min, point);
      info.max = first ? point : glm::max(info.max, point);
      first = false;
    }
  const Result<Lattice> lattice = choose_lattice(*mesh, *mesh);
  if (!lattice) return lattice.error();
  info.step = lattice->step_m;
  const Result<SmoothAngle> angle = make_smooth_angle(30);
  if (!angle) return angle.error();
  const Result<LatticeMesh> body = build_lattice_mesh(*mesh, *lattice, *angle, info.body);
  if (!body) return body.error();
  info.closed = body->closed;
  return info;
}

const char* orientation(const MeshReport::Part& part) {
  if (!part.orientable) return "not orientable";
  if (part.sheet) return "sheet";
  return part.turned ? "turned" : "outward";
}

nlohmann::ordered_json to_json(const Vec3& v) { return {v.x, v.y, v.z}; }

nlohmann::ordered_json to_json(const MeshInfo& info) {
  nlohmann::ordered_json parts = nlohmann::ordered_json::array();
  for (const MeshReport::Part& part : info.body.parts)
    parts.push_back({{"path", part.path},
                     {"triangles", part.triangles},
                     {"size", to_json(part.box_max_m - part.box_min_m)},
                     {"bounds", {{"min", to_json(part.box_min_m)}, {"max", to_json(part.box_max_m)}}},
                     {"closed", part.closed},
                     {"orientation", orientation(part)}});
  nlohmann::ordered_json notes = nlohmann::ordered_json::array();
  for (const auto* list : {&info.import.notes, &info.body.notes})
    for (const std::string& note : *list) notes.push_back(note);
  return {{"file", info.import.file},
          {"triangles", info.body.triangles},
          {"vertices", info.body.vertices},
          {"size", to_json(info.max - info.min)},
          {"bounds", {{"min", to_json(info.min)}, {"max", to_json(info.max)}}},
          {"closed", info.closed},
          {"open_edges", info.body.open_edges},
          {"nonmanifold_edges", info.body.nonmanifold_edges},
          {"largest_gap", info.body.largest_gap_m},
          {"degenerate", info.body.collapsed},
          {"duplicate", info.body.duplicate},
          {"parts", parts},
          {"notes", notes}};
}

std::string size_text(const Vec3& size) { return fmt::format("{:.6g} × {:.6g} × {:.6g}", size.x, size.y, size.z); }

/// Characters, not bytes: names and × are UTF-8.
std::size_t width(const std::string& text) {
  return static_cast<std::size_t>(std::count_if(text.begin(), text.end(), [](char c) { return (static_cast<unsigned char>(c) & 0xC0u) != 0x80u; }));
}

std::string pad(const std::string& text, std::size_t columns) {
  const std::size_t used = width(text);
  return used < columns ? text + std::string(columns - used, ' ') : text;
}

void print_table(const MeshInfo& info) {
  const MeshReport& body = info.body;
  const auto line = [](const char* name, const std::string& value) { fmt::print("  {:<12} {}\n", name, value); };
  fmt::print("{}\n", info.import.file);
  line("triangles", fmt::format("{} ({} vertices)", count_text(body.triangles), count_text(body.vertices)));
  line("size", fmt::format("{} (file units)", size_text(info.max - info.min)));
  line("bounds", fmt::format("({:.6g}, {:.6g}, {:.6g}) to ({:.6g}, {:.6g}, {:.6g})", info.min.x, info.min.y, info.min.z, info.max.x, info.max.y, info.max.z));
  line("closed", info.closed ? "yes" : fmt::format("no: {} open edges, the largest gap {:.4g} wide", count_text(body.open_edges), body.largest_gap_m));
  if (body.nonmanifold_edges > 0) line("edges", fmt::format("{} have more than two triangles", count_text(body.nonmanifold_edges)));
  line("degenerate", count_text(body.collapsed));
  line("duplicate", count_text(body.duplicate));
  for (const auto* list : {&info.import.notes, &body.notes})
    for (const std::string& note : *list) line("note", note);
  std::size_t path_width = 4, size_width = 4;
  for (const MeshReport::Part& part : body.parts) {
    path_width = std::max(path_width, width(part.path));
    size_width = std::max(size_width, width(size_text(part.box_max_m - part.box_min_m)));
  }
  fmt::print("  {}  {:>10}  {}  {:<6}  {}\n", pad("part", path_width), "triangles", pad("size", size_width), "closed", "orientation");
  for (const MeshReport::Part& part : body.parts)
    fmt::print("  {}  {:>10}  {}  {:<6}  {}\n", pad(part.path, path_width), count_text(part.triangles),
               pad(size_text(part.box_max_m - part.box_min_m), size_width), part.closed ? "yes" : "no", orientation(part));
}

struct SceneInfo {
  std::string file, prepared;
  SceneTalk talk;
};

bool is_scene(const std::string& path) { return path.ends_with(".json"); }

Result<SceneInfo> inspect_scene(const std::string& path, const ImportLimits& limits, const Parts& parts) {
  SceneOptions options;
  options.scene = path;
  options.import = limits;
  SceneInfo info{.file = path, .prepared = {}, .talk = {}};
  const PrepareWatch watch{.note = [&](const std::string& sentence) { info.prepared = sentence; },   // the last one says what was read
                           .step = [](const char*) {},
                           .progress = [](const char*, double) { return true; },
                           .admit = {},
                           .cached = true,
                           .folder = {}};
  Result<std::unique_ptr<HostedScene>> prepared = prepare_scene(options, Purpose::kQuery, parts, watch);
  if (!prepared) return prepared.error();
  Result<SceneTalk> talk = scene_talk((*prepared)->loaded, *(*prepared)->backend);
  if (!talk) return talk.error();
  info.talk = std::move(*talk);
  return info;
}

}  // namespace

Result<void> info_command(const std::vector<std::string>& files, bool json, const ImportLimits& limits, const Parts& parts) {
  // Everything is read before anything is printed, so a bad file leaves standard output empty. Scenes first: a back end is made before an import starts threads.
  std::vector<SceneInfo> scenes;
  for (const std::string& path : files) {
    if (!is_scene(path)) continue;
    Result<SceneInfo> scene = inspect_scene(path, limits, parts);
    if (!scene) return scene.error();
    scenes.push_back(std::move(*scene));
  }
  std::vector<MeshInfo> infos;
  for (const std::string& path : files) {
    if (is_scene(path)) continue;
    Result<MeshInfo> info = inspect(path, limits);
    if (!info) return info.error();
    infos.push_back(std::move(*info));
  }
  if (json) {
    nlohmann::ordered_json list = nlohmann::ordered_json::array();
    for (const MeshInfo& info : infos) list.push_back(to_json(info));
    nlohmann::ordered_json out{{"meshes", list}};
    for (const SceneInfo& scene : scenes) out["scenes"].push_back({{"file", scene.file}, {"start", scene.talk.start}, {"bodies", scene.talk.bodies}});
    fmt::print("{}\n", out.dump(2, ' ', false, nlohmann::ordered_json::error_handler_t::replace));
    return {};
  }
  for (std::size_t i = 0; i < infos.size(); ++i) {
    if (i > 0) fmt::print("\n");
    print_table(infos[i]);
  }
  for (const SceneInfo& scene : scenes) {
    if (&scene != &scenes.front() || !infos.empty()) fmt::print("\n");
    fmt::print("{}\n  {:<12} {}\n", scene.file, "read", scene.prepared);
    if (scene.talk.start.empty()) fmt::print("  {:<12} free: nothing pushes the tool\n", "start");
    for (const std::string& sentence : scene.talk.start) fmt::print("  {:<12} {}\n", "start", sentence);
    for (const std::string& sentence : scene.talk.bodies) fmt::print("  {:<12} {}\n", "note", sentence);
  }
  return {};
}

}  // namespace palpate

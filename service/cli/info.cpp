#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <glm/geometric.hpp>
#include <nlohmann/json.hpp>
#include <optional>

#include "model/files/one_line.h"
#include "model/mesh/mesh_import.h"
#include "model/scene/geometry_build.h"
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
  std::vector<std::string> also;     ///< other names of the parts; empty: none
  std::vector<std::string> colours;  ///< "#rrggbb"; empty: none
  std::vector<double> volumes;       ///< of the parts, file units³, where they are closed
  bool metres = false;               ///< sizes are in metres
  std::string unit;                  ///< what was taken for the unit, where that is a guess
  bool closed = false;
  double step = 0;      ///< of the lattice on which it was looked at, file units
  Vec3 min{0}, max{0};  ///< of the vertices that triangles use, file units
};

/// Signed volume between a part's triangles and the origin, about which a closed part doesn't care.
double volume_of(const Mesh& mesh, const MeshPart& part) {
  double six = 0;
  const Vec3 origin = mesh.vertices[mesh.triangles[part.first_triangle][0]];
  for (std::uint32_t t = part.first_triangle; t < part.first_triangle + part.triangle_count; ++t) {
    const auto& [a, b, c] = mesh.triangles[t];
    six +=
        glm::dot(mesh.vertices[a] - origin, glm::cross(mesh.vertices[b] - origin, mesh.vertices[c] - origin));
  }
  return six / 6;
}

/// "2.5 m", "191 mm".
std::string length_text(double m) {
  if (m >= 1000) return fmt::format("{:.3g} km", m / 1000);
  if (m >= 1) return fmt::format("{:.3g} m", m);
  return m >= 1e-3 ? fmt::format("{:.3g} mm", m * 1000) : fmt::format("{:.3g} µm", m * 1e6);
}

/// What a file's length is in metres and what in millimetres, where its unit is not certain.
std::string unit_guess(const std::string& path, const Vec3& size) {
  constexpr double kLargestUsual = 100;  // m, as for scenes
  if (states_unit(path)) return {};
  const double longest = std::max({size.x, size.y, size.z});
  const std::string millimetres =
      fmt::format("{}, if in millimetres (--units mm)", length_text(longest / 1000));
  if (!comes_in_metres(path))
    return fmt::format("none is stated: {} long, if in metres; {}", length_text(longest), millimetres);
  return longest > kLargestUsual
             ? fmt::format("metres by its format: {} long; {}", length_text(longest), millimetres)
             : std::string();
}

/// Import as it stands in the file (scale 1: one file unit is taken for a metre), then what a mock-up would
/// go through.
Result<MeshInfo> inspect(const std::string& path, const InfoOptions& options) {
  MeshInfo info;
  if (options.unit_m && states_unit(path))
    return bad_value(
        fmt::format("'{}' states its unit and comes in metres; --units is for files that don't", path));
  const Result<Mesh> mesh =
      import_mesh(path, options.unit_m.value_or(1), info.import, options.import, {}, options.tessellation);
  if (!mesh) return mesh.error();
  info.metres = options.unit_m || comes_in_metres(path);
  for (const MeshPart& part : mesh->parts) {
    info.also.push_back(part.also);
    info.colours.push_back(part.colour ? fmt::format("#{:06x}", *part.colour) : std::string());
    info.volumes.push_back(std::abs(volume_of(*mesh, part)));
  }
  bool first = true;
  for (const auto& triangle : mesh->triangles)
    for (const std::uint32_t vertex : triangle) {
      const Vec3& point = mesh->vertices[vertex];
      info.min = first ? point : glm::min(info.min, point);
      info.max = first ? point : glm::max(info.max, point);
      first = false;
    }
  if (!options.unit_m) info.unit = unit_guess(path, info.max - info.min);
  const Result<Lattice> lattice = choose_lattice(*mesh, *mesh);
  if (!lattice) return bad_value(fmt::format("{}: {}", path, lattice.error().sentence));
  info.step = lattice->step_m;
  const Result<SmoothAngle> angle = make_smooth_angle(30);
  if (!angle) return angle.error();
  const Result<LatticeMesh> body = build_lattice_mesh(*mesh, *lattice, *angle, info.body);
  if (!body) return bad_value(fmt::format("{}: {}", path, body.error().sentence));
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
  for (std::size_t i = 0; i < info.body.parts.size(); ++i) {
    const MeshReport::Part& part = info.body.parts[i];
    parts.push_back(
        {{"number", i + 1},
         {"path", part.path},
         {"also", info.also[i].empty() ? nlohmann::ordered_json() : nlohmann::ordered_json(info.also[i])},
         {"colour",
          info.colours[i].empty() ? nlohmann::ordered_json() : nlohmann::ordered_json(info.colours[i])},
         {"triangles", part.triangles},
         {"size", to_json(part.box_max_m - part.box_min_m)},
         {"bounds", {{"min", to_json(part.box_min_m)}, {"max", to_json(part.box_max_m)}}},
         {"closed", part.closed},
         {"volume", part.closed ? nlohmann::ordered_json(info.volumes[i]) : nlohmann::ordered_json()},
         {"orientation", orientation(part)}});
  }
  nlohmann::ordered_json notes = nlohmann::ordered_json::array();
  for (const auto* list : {&info.import.notes, &info.body.notes})
    for (const std::string& note : *list) notes.push_back(note);
  return {{"file", info.import.file},
          {"unit", info.metres ? "m" : "file"},
          {"unit_guess", info.unit.empty() ? nlohmann::ordered_json() : nlohmann::ordered_json(info.unit)},
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

std::string size_text(const Vec3& size) {
  return fmt::format("{:.6g} × {:.6g} × {:.6g}", size.x, size.y, size.z);
}

/// Characters, not bytes: names and × are UTF-8.
std::size_t width(const std::string& text) {
  return static_cast<std::size_t>(std::count_if(
      text.begin(), text.end(), [](char c) { return (static_cast<unsigned char>(c) & 0xC0u) != 0x80u; }));
}

std::string pad(const std::string& text, std::size_t columns) {
  const std::size_t used = width(text);
  return used < columns ? text + std::string(columns - used, ' ') : text;
}

void print_table(const MeshInfo& info) {
  const MeshReport& body = info.body;
  const auto line = [](const char* name, const std::string& value) {
    fmt::print("  {:<12} {}\n", name, value);
  };
  fmt::print("{}\n", info.import.file);
  line("triangles", fmt::format("{} ({} vertices)", count_text(body.triangles), count_text(body.vertices)));
  line("size", fmt::format("{} ({})", size_text(info.max - info.min), info.metres ? "m" : "file units"));
  if (!info.unit.empty()) line("unit", info.unit);
  line("bounds", fmt::format("({:.6g}, {:.6g}, {:.6g}) to ({:.6g}, {:.6g}, {:.6g})", info.min.x, info.min.y,
                             info.min.z, info.max.x, info.max.y, info.max.z));
  line("closed", info.closed            ? "yes"
                 : body.open_edges == 0 ? "no"
                                        : fmt::format("no: {} open edges, the largest gap {:.4g} wide",
                                                      count_text(body.open_edges), body.largest_gap_m));
  if (body.nonmanifold_edges > 0)
    line("edges", fmt::format("{} have more than two triangles", count_text(body.nonmanifold_edges)));
  line("degenerate", count_text(body.collapsed));
  line("duplicate", count_text(body.duplicate));
  for (const auto* list : {&info.import.notes, &body.notes})
    for (const std::string& note : *list) line("note", note);
}

/// A line of the table of parts: a part, or a node that has only others below it.
struct PartLine {
  std::string number, name, also;
  std::size_t depth = 0;
  std::uint32_t triangles = 0;
  Vec3 size{0};
  std::string closed, orientation, colour;
};

std::string named(const PartLine& line) {
  return line.also.empty() ? line.name : fmt::format("{} ({})", line.name, line.also);
}

PartLine line_of(const MeshInfo& info, std::size_t i, const std::string& name) {
  const MeshReport::Part& part = info.body.parts[i];
  return {fmt::format("#{}", i + 1),
          name,
          info.also[i],
          0,
          part.triangles,
          part.box_max_m - part.box_min_m,
          part.closed ? "yes" : "no",
          orientation(part),
          info.colours[i]};
}

std::vector<PartLine> listed_parts(const MeshInfo& info) {
  std::vector<PartLine> lines;
  for (std::size_t i = 0; i < info.body.parts.size(); ++i)
    lines.push_back(line_of(info, i, info.body.parts[i].path));
  return lines;
}

/// The hierarchy: a node of the file a line, what is below it further in.
std::vector<PartLine> tree_of(const MeshInfo& info) {
  struct Open {
    std::string path;
    std::size_t line;
    Vec3 min{INFINITY}, max{-INFINITY};
    bool closed = true;
  };
  std::vector<PartLine> lines;
  std::vector<Open> open;  // from the root to the last part's node
  const auto close = [&] {
    const Open last = std::move(open.back());
    open.pop_back();
    PartLine& line = lines[last.line];
    line.size = last.max - last.min;
    line.closed = last.closed ? "yes" : "no";
    if (open.empty()) return;
    Open& above = open.back();
    lines[above.line].triangles += line.triangles;
    above.min = glm::min(above.min, last.min), above.max = glm::max(above.max, last.max);
    above.closed = above.closed && last.closed;
  };
  for (std::size_t i = 0; i < info.body.parts.size(); ++i) {
    const MeshReport::Part& part = info.body.parts[i];
    while (!open.empty() && !is_below(part.path, open.back().path)) close();
    while (open.empty() || open.back().path != part.path) {
      const std::size_t begin = open.empty() ? 0 : open.back().path.size() + 1;
      const std::string path = part.path.substr(0, part.path.find('/', begin));
      lines.push_back({.number = {},
                       .name = path.substr(begin),
                       .also = {},
                       .depth = open.size(),
                       .closed = {},
                       .orientation = {},
                       .colour = {}});
      open.push_back({path, lines.size() - 1});
    }
    Open& node = open.back();
    PartLine& line = lines[node.line];
    const PartLine own = line_of(info, i, line.name);
    line.number = own.number, line.also = own.also, line.orientation = own.orientation,
    line.colour = own.colour;
    line.triangles += own.triangles;
    node.min = glm::min(node.min, part.box_min_m), node.max = glm::max(node.max, part.box_max_m);
    node.closed = node.closed && part.closed;
  }
  while (!open.empty()) close();
  return lines;
}

/// The lines from `at` on that are `depth` deep, each with those below it.
nlohmann::ordered_json to_json(const std::vector<PartLine>& lines, std::size_t& at, std::size_t depth) {
  nlohmann::ordered_json nodes = nlohmann::ordered_json::array();
  while (at < lines.size() && lines[at].depth == depth) {
    const PartLine& line = lines[at++];
    nlohmann::ordered_json node{{"name", line.name},
                                {"triangles", line.triangles},
                                {"size", to_json(line.size)},
                                {"closed", line.closed == "yes"}};
    if (!line.also.empty()) node["also"] = line.also;
    if (!line.colour.empty()) node["colour"] = line.colour;
    if (!line.number.empty()) node["number"] = std::stoul(line.number.substr(1));
    if (nlohmann::ordered_json below = to_json(lines, at, depth + 1); !below.empty())
      node["below"] = std::move(below);
    nodes.push_back(std::move(node));
  }
  return nodes;
}

void print_parts(const std::vector<PartLine>& lines) {
  std::size_t number_width = 1, name_width = 4, size_width = 4;
  for (const PartLine& line : lines) {
    number_width = std::max(number_width, line.number.size());
    name_width = std::max(name_width, 2 * line.depth + width(named(line)));
    size_width = std::max(size_width, width(size_text(line.size)));
  }
  const bool colours =
      std::any_of(lines.begin(), lines.end(), [](const PartLine& line) { return !line.colour.empty(); });
  fmt::print("  {}  {}  {:>10}  {}  {:<6}  {}\n", pad("#", number_width), pad("part", name_width),
             "triangles", pad("size", size_width), "closed",
             colours ? "orientation     colour" : "orientation");
  for (const PartLine& line : lines)
    fmt::print("  {}  {}  {:>10}  {}  {:<6}  {}\n", pad(line.number, number_width),
               pad(std::string(2 * line.depth, ' ') + named(line), name_width), count_text(line.triangles),
               pad(size_text(line.size), size_width), line.closed,
               line.colour.empty() ? line.orientation : pad(line.orientation, 14) + "  " + line.colour);
}

struct SceneInfo {
  std::string file, prepared;
  std::vector<std::string> warnings;  ///< of reading it
  SceneTalk talk;
};

bool is_scene(const std::string& path) { return path.ends_with(".json"); }

Result<SceneInfo> inspect_scene(const std::string& path, const ImportLimits& limits, const Parts& parts) {
  SceneOptions options;
  options.scene = path;
  options.import = limits;
  SceneInfo info{.file = path, .prepared = {}, .warnings = {}, .talk = {}};
  const PrepareWatch watch{
      .note =
          [&](const std::string& sentence) { info.prepared = sentence; },  // the last one says what was read
      .step = [](const char*) {},
      .progress = [](const char*, double) { return true; },
      .admit = {},
      .cached = true,
      .folder = {}};
  Result<std::unique_ptr<HostedScene>> prepared = prepare_scene(options, Purpose::kQuery, parts, watch);
  if (!prepared) return prepared.error();
  info.warnings = (*prepared)->loaded.scene.warnings;
  Result<SceneTalk> talk = scene_talk((*prepared)->loaded, *(*prepared)->backend);
  if (!talk) return talk.error();
  info.talk = std::move(*talk);
  return info;
}

}  // namespace

Result<void> info_command(const InfoOptions& options, const Parts& parts) {
  // Scenes first: a back end is made before an import starts threads. What can be read is told whatever
  // becomes of the others; the last reason is this command's.
  std::optional<Error> failed;
  const auto fail = [&failed](const Error& error) {
    if (failed) std::fprintf(stderr, "palpate: %s\n", one_line(failed->sentence).c_str());
    failed = error;
  };
  std::vector<SceneInfo> scenes;
  for (const std::string& path : options.files) {
    if (!is_scene(path)) continue;
    Result<SceneInfo> scene = inspect_scene(path, options.import, parts);
    if (scene)
      scenes.push_back(std::move(*scene));
    else
      fail(scene.error());
  }
  std::vector<MeshInfo> infos;
  for (const std::string& path : options.files) {
    if (is_scene(path)) continue;
    Result<MeshInfo> info = inspect(path, options);
    if (info)
      infos.push_back(std::move(*info));
    else
      fail(info.error());
  }
  if (infos.empty() && scenes.empty()) return *failed;
  if (options.json) {
    nlohmann::ordered_json list = nlohmann::ordered_json::array();
    for (const MeshInfo& info : infos) {
      list.push_back(to_json(info));
      if (std::size_t first = 0; options.tree) list.back()["tree"] = to_json(tree_of(info), first, 0);
    }
    nlohmann::ordered_json out{{"meshes", list}};
    for (const SceneInfo& scene : scenes)
      out["scenes"].push_back({{"file", scene.file},
                               {"free", scene.talk.free},
                               {"start", scene.talk.start},
                               {"bodies", scene.talk.bodies},
                               {"warnings", scene.warnings}});
    fmt::print("{}\n", out.dump(2, ' ', false, nlohmann::ordered_json::error_handler_t::replace));
    return failed ? Result<void>(*failed) : Result<void>();
  }
  for (std::size_t i = 0; i < infos.size(); ++i) {
    if (i > 0) fmt::print("\n");
    print_table(infos[i]);
    print_parts(options.tree ? tree_of(infos[i]) : listed_parts(infos[i]));
  }
  for (const SceneInfo& scene : scenes) {
    if (&scene != &scenes.front() || !infos.empty()) fmt::print("\n");
    fmt::print("{}\n  {:<12} {}\n", scene.file, "read", scene.prepared);
    if (scene.talk.free) fmt::print("  {:<12} free: nothing touches the tool\n", "start");
    for (const std::string& sentence : scene.talk.start) fmt::print("  {:<12} {}\n", "start", sentence);
    for (const auto* sentences : {&scene.talk.bodies, &scene.warnings})
      for (const std::string& sentence : *sentences) fmt::print("  {:<12} {}\n", "note", sentence);
  }
  return failed ? Result<void>(*failed) : Result<void>();
}

}  // namespace palpate

#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstdio>
#include <filesystem>
#include <map>
#include <utility>

#include "model/cache/geometry_cache.h"
#include "model/generate.h"
#include "model/generate/solids.h"
#include "model/mesh/confined_import.h"
#include "model/mesh/thicken.h"
#include "model/scene/scene_file.h"

namespace palpate {
namespace {

constexpr double kLargestUsual = 100,
                 kSmallestUsual = 1e-3;  ///< m; beyond, the units are probably not the right ones
constexpr double kWallsPerTool = 64;     ///< "sheet_thickness": "auto" (chosen: docs/ACCURACY.md)

std::string source_name(const MeshSource& source) {
  return source.file.empty() ? "the generated " + source.generate : source.file;
}

/// Short name of a body, to tell the parts of several apart.
std::string prefix_of(const MeshSource& source) {
  return source.file.empty() ? source.generate : std::filesystem::path(source.file).stem().string();
}

Result<Mesh> generate(const MeshSource& source) {
  const auto slash = source.generate.find('/');
  const bool tool = source.generate.substr(slash + 1) == "tool";
  const auto asked = source.generate_parameters.find("triangles");
  const auto triangles =
      asked == source.generate_parameters.end() ? 0 : static_cast<std::uint64_t>(asked->second);
  constexpr std::uint64_t kUnused = 1'000;  // of the body that is not asked for
  auto scene = generate_scene(source.generate.substr(0, slash), tool ? kUnused : triangles,
                              tool ? triangles : kUnused);
  if (!scene) return scene.error();
  return tool ? std::move(scene->tool) : std::move(scene->mockup);
}

Mesh scaled(Mesh mesh, double scale) {
  for (Vec3& vertex : mesh.vertices) vertex *= scale;
  return mesh;
}

/// Reads the files of a scene, each once: what several bodies take from one file is kept until the last has
/// had it.
class Files {
 public:
  Files(const Scene& scene, const std::string& folder, const ImportLimits& limits)
      : folder_(folder), limits_(limits) {
    ++uses_[key(scene.tool.source)];
    for (const StaticBody& body : scene.statics) ++uses_[key(body.source)];
  }

  Result<Mesh> read(const MeshSource& source, const Tessellation& tessellation,
                    const ImportProgress& progress, std::vector<std::string>& warnings) {
    int& uses = uses_[key(source)];
    const auto kept = kept_.find(key(source));
    if (kept != kept_.end()) {
      if (--uses > 0) return kept->second;
      Mesh last = std::move(kept->second);
      kept_.erase(kept);
      return last;
    }
    if (source.given) return scaled(*source.given, source.scale);
    ImportReport report;
    Result<Mesh> mesh =
        import_mesh_below(folder_, source.file, source.scale, report, limits_, progress, tessellation);
    if (!mesh) return mesh;
    for (const std::string& note : report.notes) warnings.push_back(source.file + ": " + note);
    if (--uses > 0) kept_[key(source)] = *mesh;
    return mesh;
  }

 private:
  using Key = std::pair<std::string, double>;
  static Key key(const MeshSource& source) { return {source.file, source.scale}; }

  const std::string& folder_;
  const ImportLimits& limits_;
  std::map<Key, int> uses_;  ///< still to come
  std::map<Key, Mesh> kept_;
};

/// Whether every corner is a place: of a mesh in memory that can't be said. Whoever welds it tells what is
/// wrong.
bool all_are_places(const Mesh& mesh) {
  const auto far = [](const Vec3& v) {
    return !(std::fabs(v.x) < 1e9 && std::fabs(v.y) < 1e9 && std::fabs(v.z) < 1e9);
  };
  return std::none_of(mesh.vertices.begin(), mesh.vertices.end(), far) &&
         std::all_of(mesh.triangles.begin(), mesh.triangles.end(), [&](const auto& triangle) {
           return std::all_of(triangle.begin(), triangle.end(),
                              [&](std::uint32_t v) { return v < mesh.vertices.size(); });
         });
}

/// `tool_side`: the tool's longest, m. `body`: mock-up or tool, for sentences.
Result<Mesh> walled(Mesh mesh, const MeshSource& source, double tool_side, const char* body,
                    std::vector<std::string>& warnings) {
  const double thickness = source.sheet_thickness_m.value_or(
      std::clamp(tool_side / kWallsPerTool, kThinnestSheet, kThickestSheet));
  if (!(thickness > 0) || !all_are_places(mesh)) return mesh;  // what is no place is refused later
  std::optional<Enclosure> enclosure;
  if (!source.sheet_thickness_m) {
    Result<Enclosure> found = Enclosure::of(mesh);
    if (!found) return bad_value(source_name(source) + ": " + found.error().sentence);
    enclosure = std::move(*found);
  }
  Thickened thick = thicken(mesh, thickness, enclosure ? &*enclosure : nullptr);
  const std::string spared =
      thick.spared == 0
          ? ""
          : fmt::format("; {} in open pieces that bound an inside stay as they are", thick.spared);
  if (thick.walls == 0) {
    warnings.push_back(fmt::format("{} {}: no piece of it is {}, so \"sheet_thickness\" changes nothing{}",
                                   body, source_name(source), enclosure ? "a sheet" : "open", spared));
    return mesh;
  }
  warnings.push_back(fmt::format(
      "{} {}: {} of {} triangles lie in open pieces and are walls {:.3g} mm thick now; it has {} "
      "triangles{}{}",
      body, source_name(source), thick.walls, mesh.triangles.size(), 1e3 * thickness,
      thick.mesh.triangles.size(),
      thick.copies == 0 ? "" : fmt::format(", without {} that were there twice", thick.copies), spared));
  return std::move(thick.mesh);
}

Result<Mesh> mesh_of(const MeshSource& source, Files& files, const Tessellation& tessellation,
                     const ImportProgress& progress, std::vector<std::string>& warnings) {
  Result<Mesh> mesh =
      source.file.empty() ? generate(source) : files.read(source, tessellation, progress, warnings);
  if (!mesh) return mesh;
  if (!source.part.empty()) mesh = take_part(*mesh, source.part, source_name(source));
  if (mesh && !source.without.empty()) {
    auto rest = without_parts(*mesh, source.without, source_name(source));
    if (!rest && !source.part.empty())
      return bad_value(
          fmt::format("of \"without\", in part '{}' alone: {}", source.part, rest.error().sentence));
    mesh = std::move(rest);
  }
  if (mesh && mesh->triangles.empty())
    return bad_value(source_name(source) + " has no triangle left after \"part\" and \"without\"");
  return mesh;
}

/// What tells each body's parts apart: short names, of several alike the second with "#2"; none for a single
/// body.
std::vector<std::string> prefixes_of(const std::vector<StaticBody>& bodies) {
  std::vector<std::string> out;
  for (const StaticBody& body : bodies) {
    const std::string own = prefix_of(body.source);
    std::string name = own;
    for (int number = 2; std::find(out.begin(), out.end(), name) != out.end(); ++number)
      name = own + "#" + std::to_string(number);
    out.push_back(std::move(name));
  }
  if (out.size() == 1) out.front().clear();
  return out;
}

/// Adds a placed body to the mock-up; its parts get `prefix`. `own`: the body's own name.
void place(const Mesh& body, const Pose& placement, const std::string& own, const std::string& prefix,
           Mesh& mockup) {
  const auto vertex = static_cast<std::uint32_t>(mockup.vertices.size());
  const auto triangle = static_cast<std::uint32_t>(mockup.triangles.size());
  for (const Vec3& v : body.vertices) mockup.vertices.push_back(placement.rotation * v + placement.position);
  for (const auto& [a, b, c] : body.triangles)
    mockup.triangles.push_back({a + vertex, b + vertex, c + vertex});
  for (const MeshPart& part : body.parts) {
    const bool whole = part.path.empty() || part.path == own;  // a mesh in memory is a part of its name
    const std::string path = prefix.empty() ? part.path : whole ? prefix : prefix + "/" + part.path;
    mockup.parts.push_back(
        {path, part.first_triangle + triangle, part.triangle_count, part.also, part.colour});
  }
}

/// Longest side of the box of all vertices that a triangle uses.
double extent(const Mesh& mesh) {
  Vec3 low(INFINITY), high(-INFINITY);
  for (const auto& triangle : mesh.triangles)
    for (const std::uint32_t i : triangle) {
      low = glm::min(low, mesh.vertices[i]);
      high = glm::max(high, mesh.vertices[i]);
    }
  const Vec3 size = high - low;
  return std::fmax(size.x, std::fmax(size.y, size.z));
}

void warn_of_size(const char* what, const Mesh& mesh, std::vector<std::string>& warnings) {
  const double size = extent(mesh);
  if (size >= kSmallestUsual && size <= kLargestUsual) return;
  char text[160];
  std::snprintf(text, sizeof text, "the %s is %.3g m long, %s; check \"units\"", what, size,
                size > kLargestUsual ? "over 100 m" : "under 1 mm");
  warnings.emplace_back(text);
}

/// docs/ACCURACY.md: from a voxel on the force of a contact a few voxels wide is off by 5 % and more. Not
/// kept with the geometry, which is the same for `paper`.
void warn_of_spacing(Scene& scene, const SceneGeometry& geometry) {
  if (scene.response.profile != Profile::kRefined || geometry.sample_spacing < geometry.mockup_grid.size)
    return;
  char text[200];
  std::snprintf(text, sizeof text,
                "samples are %.3g m apart, not less than a voxel (%.3g m): the force of a contact a few of "
                "them wide or deep is off by 5 %% and more",
                geometry.sample_spacing * geometry.lattice.step_m,
                geometry.mockup_grid.size * geometry.lattice.step_m);
  scene.warnings.emplace_back(text);
}

/// What the scene says of samples and voxels asks for this much; 0: it says nothing.
double stated_deflection(const ResponseSettings& response) {
  constexpr double kDeflectionsPerSample = 4, kSamplesPerVoxel = 4;
  if (response.tessellation_m) return *response.tessellation_m;
  if (response.sample_spacing_m) return *response.sample_spacing_m / kDeflectionsPerSample;
  return response.voxel_size_m ? *response.voxel_size_m / kSamplesPerVoxel / kDeflectionsPerSample : 0;
}

/// Parts of which nothing is left on the lattice.
void warn_of_vanished(const char* what, const MeshReport& report, double step_m,
                      std::vector<std::string>& warnings) {
  std::size_t count = 0;
  const MeshReport::Part* first = nullptr;
  for (const MeshReport::Part& part : report.parts) {
    if (part.collapsed < part.triangles) continue;
    if (++count == 1) first = &part;
  }
  if (count == 0) return;
  char size[32];
  std::snprintf(size, sizeof size, "%.3g", step_m);
  warnings.push_back(std::to_string(count) + (count == 1 ? " part of the " : " parts of the ") + what +
                     (count == 1 ? " has" : " have") + " no area on the lattice, whose step is " + size +
                     " m, and can't be touched: '" + first->path + "'" + (count > 1 ? " and others" : ""));
}

bool tell(const Progress& progress, const char* what, double done) {
  return !progress || progress(what, done);
}

}  // namespace

Result<SceneMeshes> import_scene(Scene& scene, const Progress& progress, const ImportLimits& limits,
                                 const std::string& folder) {
  const Error cancelled{ErrorCode::kInternal, scene.file + ": loading was cancelled"};
  SceneMeshes meshes;
  const double bodies = static_cast<double>(scene.statics.size()) + 1;
  Files files(scene, folder, limits);
  // The tool comes first: where nothing else says how finely the mock-up's curved surfaces are made of
  // triangles, the tool's size does.
  const auto of_body = [&](std::size_t body) {
    return [&progress, body, bodies](const char* what, double done) {
      return tell(progress, what, (static_cast<double>(body) + done) / bodies);
    };
  };
  if (!tell(progress, "import", 0)) return cancelled;
  Tessellation tessellation{stated_deflection(scene.response), scene.response.tessellation_angle_deg,
                            scene.tool.source.part};
  auto tool = mesh_of(scene.tool.source, files, tessellation, of_body(0), scene.warnings);
  if (!tool) return tool.error();
  const double side = extent(*tool);
  if (tessellation.deflection_m == 0) tessellation.deflection_m = side / kDeflectionsPerSide;
  tool = walled(std::move(*tool), scene.tool.source, side, "tool", scene.warnings);
  if (!tool) return tool.error();
  meshes.tool = std::move(*tool);
  const std::vector<std::string> prefixes = prefixes_of(scene.statics);
  for (std::size_t i = 0; i < scene.statics.size(); ++i) {
    const auto body_progress = of_body(i + 1);
    if (!body_progress("import", 0)) return cancelled;
    const StaticBody& body = scene.statics[i];
    auto mesh = mesh_of(body.source, files, tessellation, body_progress, scene.warnings);
    if (mesh) mesh = walled(std::move(*mesh), body.source, side, "mock-up", scene.warnings);
    if (!mesh) return mesh.error();
    place(*mesh, body.placement, prefix_of(body.source), prefixes[i], meshes.mockup);
  }
  warn_of_size("mock-up", meshes.mockup, scene.warnings);
  warn_of_size("tool", meshes.tool, scene.warnings);
  return meshes;
}

Result<LoadedScene> load_scene(Scene scene, const Progress& progress, const ImportLimits& limits,
                               DiskCache* cache, const std::string& folder) {
  const Error cancelled{ErrorCode::kInternal, scene.file + ": loading was cancelled"};
  const auto start = std::chrono::steady_clock::now();
  const std::optional<ContentKey> key = cache ? geometry_key(scene) : std::nullopt;
  if (key)
    if (auto found = find_geometry(*cache, *key)) {
      scene.warnings.insert(scene.warnings.end(), found->warnings.begin(), found->warnings.end());
      if (!tell(progress, "geometry", 1)) return cancelled;
      warn_of_spacing(scene, found->geometry);
      return LoadedScene{std::move(scene), std::move(found->geometry), true};
    }

  const auto warnings_before = static_cast<std::ptrdiff_t>(scene.warnings.size());
  LoadedGeometry loaded;
  {
    const auto meshes = import_scene(scene, progress, limits, folder);
    if (!meshes) return meshes.error();
    if (!tell(progress, "geometry", 0)) return cancelled;
    auto geometry = build_geometry(
        meshes->mockup, meshes->tool,
        {scene.response.voxel_size_m, scene.response.sample_spacing_m, scene.response.smooth_angle_deg,
         scene.tool.centre_of_mass_m, scene.response.contact_samples},
        [&] { return tell(progress, "geometry", 0); });
    if (!geometry) return Error{geometry.error().code, scene.file + ": " + geometry.error().sentence};
    loaded.geometry = std::move(*geometry);
  }
  if (!tell(progress, "geometry", 1)) return cancelled;
  warn_of_vanished("mock-up", loaded.geometry.mockup_report, loaded.geometry.lattice.step_m, scene.warnings);
  warn_of_vanished("tool", loaded.geometry.tool_report, loaded.geometry.lattice.step_m, scene.warnings);
  if (!loaded.geometry.tool.closed && !scene.tool.centre_of_mass_m)
    scene.warnings.push_back("the tool " + source_name(scene.tool.source) + " is open (" +
                             std::to_string(loaded.geometry.tool_report.open_edges) +
                             " open edges); its centre of mass is taken for the centroid of its area");
  if (key) {
    loaded.warnings.assign(scene.warnings.begin() + warnings_before, scene.warnings.end());
    keep_geometry(*cache, *key, loaded,
                  std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count());
  }
  warn_of_spacing(scene, loaded.geometry);
  return LoadedScene{std::move(scene), std::move(loaded.geometry), false};
}

}  // namespace palpate

#include "model/cache/geometry_cache.h"

#include <algorithm>
#include <array>
#include <cctype>
#include <cstdio>
#include <memory>

#include "model/cache/archive.h"
#include "model/files/file_view.h"

namespace palpate {
namespace {

constexpr const char* kKind = "geometry";

// One list of members for writing and reading.
// --------------------------------------------------------------------------

template <class Archive, class Grid>
void archive_grid(Archive& a, Grid& grid) {
  a(grid.origin);
  a(grid.size);
  a(grid.bricks);
}

template <class Archive, class LatticeMeshOrConst>
void archive_mesh(Archive& a, LatticeMeshOrConst& mesh) {
  a(mesh.vertices);
  a(mesh.triangles);
  a(mesh.flags);
  a(mesh.unit_normal_q30);
  a(mesh.sample_weight_q30);
  a(mesh.sample_axis);
  a(mesh.neighbour_begin);
  a(mesh.neighbours);
  a(mesh.patch);
  a(mesh.patch_count);
  a(mesh.field_weight_q30);
  a(mesh.extra_samples);
  a(mesh.levels_of);
  a(mesh.side_levels);
  a(mesh.grid_samples);
  a(mesh.closed);
  a(mesh.box_min);
  a(mesh.box_max);
}

template <class Archive, class Report>
void archive_report(Archive& a, Report& report) {
  a.each(report.parts, [](Archive& part_archive, auto& part) {
    part_archive(part.path);
    part_archive(part.triangles);
    part_archive(part.collapsed);
    part_archive(part.closed);
    part_archive(part.sheet);
    part_archive(part.turned);
    part_archive(part.orientable);
    part_archive(part.box_min_m);
    part_archive(part.box_max_m);
  });
  a(report.triangles);
  a(report.vertices);
  a(report.collapsed);
  a(report.duplicate);
  a(report.open_edges);
  a(report.nonmanifold_edges);
  a(report.largest_gap_m);
  a.each(report.notes, [](Archive& note_archive, auto& note) { note_archive(note); });
}

/// All of it but the reports.
template <class Archive, class Geometry>
void archive_shape(Archive& a, Geometry& g) {
  a(g.lattice.step_m);
  a(g.lattice.origin_m);
  archive_mesh(a, g.mockup);
  archive_mesh(a, g.tool);
  a(g.mockup_surface);
  a(g.tool_surface);
  a(g.tool_centre_m);
  a(g.tool_gc_m);
  a(g.tool_gc);
  a(g.tool_radius);
  archive_grid(a, g.mockup_grid);
  archive_grid(a, g.tool_grid);
  a(g.sample_spacing);
  a(g.contact_samples);
  a(g.reference_area_m2);
  a(g.tool_gyration_m);
  a(g.smooth_angle.cos2_numerator);
  a(g.smooth_angle.cos2_denominator);
}

template <class Archive, class Loaded>
void archive_loaded(Archive& a, Loaded& loaded) {
  archive_shape(a, loaded.geometry);
  archive_report(a, loaded.geometry.mockup_report);
  archive_report(a, loaded.geometry.tool_report);
  a.each(loaded.warnings, [](Archive& warning_archive, auto& warning) { warning_archive(warning); });
}

// ---- the key
// -----------------------------------------------------------------------------------------------------------

/// Whether a binary glTF may name other files: its JSON chunk, the first, holds a "uri".
bool glb_stands_alone(const std::string& path) {
  const std::unique_ptr<std::FILE, int (*)(std::FILE*)> in(std::fopen(path.c_str(), "rbe"), &std::fclose);
  std::array<unsigned char, 20> head{};
  if (!in || std::fread(head.data(), 1, head.size(), in.get()) != head.size()) return false;
  const std::size_t json =
      head[12] | std::size_t{head[13]} << 8 | std::size_t{head[14]} << 16 | std::size_t{head[15]} << 24;
  if (json > (std::size_t{64} << 20)) return false;
  std::string text(json, '\0');
  return std::fread(text.data(), 1, json, in.get()) == json && text.find("\"uri\"") == std::string::npos;
}

/// Whether a STEP file may name other files.
bool step_stands_alone(const std::string& path) {
  const Result<FileView> file = FileView::open(path);
  return file && file->bytes().find("DOCUMENT_FILE") == std::string_view::npos;
}

}  // namespace

bool stands_alone(const std::string& path) {
  const auto dot = path.rfind('.');
  if (dot == std::string::npos) return false;
  std::string ending = path.substr(dot + 1);
  std::transform(ending.begin(), ending.end(), ending.begin(),
                 [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
  return ending == "stl" || ending == "ply" || ending == "off" || ending == "3mf" || ending == "iges" ||
         ending == "igs" || ending == "brep" || ending == "brp" ||
         ((ending == "step" || ending == "stp") && step_stands_alone(path)) ||
         (ending == "glb" && glb_stands_alone(path));
}

namespace {

template <class T>
void add_optional(KeyBuilder& key, const std::optional<T>& value) {
  key.value(std::uint8_t{value.has_value()});
  if constexpr (std::is_same_v<T, Vec3>) {
    if (value)
      for (int k = 0; k < 3; ++k) key.value((*value)[k]);
  } else {
    if (value) key.value(*value);
  }
}

bool add_source(KeyBuilder& key, const MeshSource& source) {
  key.text(source.file);  // its name is in warnings
  key.value(std::uint8_t{source.given != nullptr});
  if (source.given) {
    key.list(source.given->vertices);
    key.list(source.given->triangles);
  } else if (!source.file.empty() && (!stands_alone(source.file) || !key.file(source.file))) {
    return false;
  }
  key.value(source.scale);
  key.text(source.part);
  key.value(source.without.size());
  for (const std::string& name : source.without) key.text(name);
  add_optional(key, source.sheet_thickness_m);
  key.text(source.generate);
  key.value(source.generate_parameters.size());
  for (const auto& [name, value] : source.generate_parameters) {
    key.text(name);
    key.value(value);
  }
  return true;
}

/// Hashes instead of writing: the third archive over the same list of members.
class KeyArchive {
 public:
  explicit KeyArchive(KeyBuilder& key) : key_(key) {}
  template <PlainValue T>
  void operator()(const T& v) {
    key_.bytes(&v, sizeof v);  // numbers and vectors of numbers: no padding
  }
  template <PlainValue T>
  void operator()(const std::vector<T>& v) {
    key_.list(v);
  }

 private:
  KeyBuilder& key_;
};

}  // namespace

std::optional<ContentKey> geometry_key(const Scene& scene) {
  if (program_key() == ContentKey{}) return std::nullopt;
  KeyBuilder key;
  key.value(program_key().high);
  key.value(program_key().low);
  key.text(scene.file);  // its name is in warnings and errors
  key.value(scene.statics.size());
  for (const StaticBody& body : scene.statics) {
    if (!add_source(key, body.source)) return std::nullopt;
    for (int k = 0; k < 3; ++k) key.value(body.placement.position[k]);
    for (int k = 0; k < 4; ++k) key.value(body.placement.rotation[k]);
  }
  if (!add_source(key, scene.tool.source)) return std::nullopt;
  add_optional(key, scene.tool.centre_of_mass_m);
  add_optional(key, scene.response.voxel_size_m);
  add_optional(key, scene.response.sample_spacing_m);
  add_optional(key, scene.response.tessellation_m);
  key.value(scene.response.tessellation_angle_deg);
  key.value(scene.response.smooth_angle_deg);
  key.value(scene.response.contact_samples);
  return key.finish();
}

std::optional<LoadedGeometry> find_geometry(DiskCache& cache, const ContentKey& key) {
  const auto entry = cache.find(kKind, key);
  if (!entry) return std::nullopt;
  ArchiveReader reader(entry->payload());
  LoadedGeometry loaded;
  archive_loaded(reader, loaded);
  if (reader.complete()) return loaded;
  cache.drop(kKind, key, "does not hold what it should");
  return std::nullopt;
}

void keep_geometry(DiskCache& cache, const ContentKey& key, const LoadedGeometry& loaded, double seconds) {
  ArchiveWriter writer;
  archive_loaded(writer, loaded);
  cache.keep(kKind, key, writer.pieces(), seconds);
}

void add_geometry(KeyBuilder& key, const SceneGeometry& geometry) {
  KeyArchive archive(key);
  archive_shape(archive, geometry);
}

}  // namespace palpate

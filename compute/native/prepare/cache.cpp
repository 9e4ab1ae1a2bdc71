#include "compute/native/prepare/cache.h"

#include <utility>

#include "compute/scene/archive.h"
#include "compute/scene/search_tables.h"
#include "model/cache/archive.h"
#include "model/cache/geometry_cache.h"

namespace palpate::native {
namespace {

constexpr const char* kKind = "native";

template <class Archive, class SceneLike>
void archive_scene(Archive& a, SceneLike& scene) {
  a(scene.constants);
  for (auto* partition : {&scene.mockup, &scene.tool, &scene.fine}) archive_partition(a, *partition);
  a(scene.fine_exit);
  a(scene.tool_near);
}

}  // namespace

ContentKey scene_key(const SceneGeometry& geometry) {
  KeyBuilder key;
  key.value(program_key().high);
  key.value(program_key().low);
  add_geometry(key, geometry);
  return key.finish();
}

std::optional<Scene> find_scene(DiskCache& cache, const ContentKey& key) {
  const auto entry = cache.find(kKind, key);
  if (!entry) return std::nullopt;
  ArchiveReader reader(entry->payload());
  Scene scene;
  archive_scene(reader, scene);
  auto samples = std::make_shared<VoxelSamples>();
  archive_samples(reader, *samples);
  if (samples->listed()) scene.samples = std::move(samples);
  auto tables = std::make_shared<SearchTables>();
  archive_tables(reader, *tables);
  scene.search = std::move(tables);
  for (auto* shells : {&scene.mockup_shells, &scene.tool_shells}) {
    bool counted = false;
    reader(counted);
    if (!counted) continue;
    auto made = std::make_shared<OpenShells>();
    OpenShells::archive(reader, *made);
    *shells = std::move(made);
  }
  if (reader.complete()) return scene;
  cache.drop(kKind, key, "does not hold what it should");
  return std::nullopt;
}

void keep_scene(DiskCache& cache, const ContentKey& key, const Scene& scene, double seconds) {
  static const VoxelSamples kNone;
  ArchiveWriter writer;
  archive_scene(writer, scene);
  archive_samples(writer, scene.samples ? *scene.samples : kNone);
  archive_tables(writer, *scene.search);
  for (const auto* shells : {&scene.mockup_shells, &scene.tool_shells}) {
    writer(*shells != nullptr);
    if (*shells) OpenShells::archive(writer, **shells);
  }
  cache.keep(kKind, key, writer.pieces(), seconds);
}

}  // namespace palpate::native

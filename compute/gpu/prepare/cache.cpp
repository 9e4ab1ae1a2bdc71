#include "compute/gpu/prepare/cache.h"

#include <utility>
#include <vector>

#include "model/cache/archive.h"
#include "model/cache/geometry_cache.h"

namespace palpate {
namespace {

constexpr const char* kKind = "prepared";

/// What is not in a buffer.
template <class Archive, class Scene>
void archive_numbers(Archive& a, Scene& scene) {
  a(scene.constants);
  for_each_partition(scene, [&](auto& partition) {
    a(partition.grid);
    a(partition.has_internal);
  });
}

}  // namespace

ContentKey prepared_key(const VulkanDevice& device, const SceneGeometry& geometry, const Plan& plan) {
  KeyBuilder key;
  key.value(program_key().high);
  key.value(program_key().low);
  key.text(device.name());
  key.text(device.driver());
  key.value(device.limits().storage_range);  // what does not fit is left to the frame
  key.value(plan.profile);
  add_geometry(key, geometry);
  return key.finish();
}

std::optional<PreparedScene> find_prepared(VulkanDevice& device, DiskCache& cache, const ContentKey& key,
                                           const SceneGeometry& geometry, const Plan& plan) {
  const auto entry = cache.find(kKind, key);
  if (!entry) return std::nullopt;
  ArchiveReader reader(entry->payload());
  PreparedScene scene;
  bool room = static_cast<bool>(upload_meshes(device, geometry, plan, scene));
  archive_numbers(reader, scene);
  for_each_made_buffer(scene, [&](VulkanBuffer& buffer) {
    std::uint64_t bytes = 0;
    BufferKind kind{};
    reader(bytes);
    reader(kind);
    const std::string_view content = reader.take(bytes);
    if (!room || content.empty()) return;  // empty buffers stay empty
    auto made = VulkanBuffer::create(device, "a scene from the cache", bytes, kind);
    room = made && upload(device, *made, content.data(), content.size());
    if (room) buffer = std::move(*made);
  });
  if (!reader.complete()) {
    cache.drop(kKind, key, "does not hold what it should");
    return std::nullopt;
  }
  if (!room) return std::nullopt;
  return scene;
}

void keep_prepared(VulkanDevice& device, DiskCache& cache, const ContentKey& key, const PreparedScene& scene,
                   double seconds) {
  ArchiveWriter writer;
  archive_numbers(writer, scene);
  std::vector<std::vector<char>> copies;  // of what the host can't see
  copies.reserve(64);
  bool whole = true;
  for_each_made_buffer(scene, [&](const VulkanBuffer& buffer) {
    writer(buffer.bytes());
    writer(buffer.kind());
    if (buffer.bytes() == 0) return;
    if (buffer.as<char>() == nullptr) {
      auto& copy = copies.emplace_back(buffer.bytes());
      whole = whole && download(device, buffer, 0, copy.data(), copy.size());
      writer.borrow({copy.data(), copy.size()});
    } else {
      writer.borrow({buffer.as<char>(), buffer.bytes()});
    }
  });
  if (whole) cache.keep(kKind, key, writer.pieces(), seconds);
}

}  // namespace palpate

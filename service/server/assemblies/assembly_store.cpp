#include "service/server/assemblies/assembly_store.h"

#include <algorithm>
#include <array>
#include <cctype>
#include <cmath>
#include <cstdio>
#include <nlohmann/json.hpp>
#include <random>

#include "model/mesh/confined_import.h"
#include "service/server/http/json_input.h"
#include "service/server/http/safe_path.h"

namespace palpate {
namespace {

namespace fs = std::filesystem;
using nlohmann::ordered_json;

constexpr std::array kMeshEndings = {".stl", ".obj", ".ply",  ".off", ".gltf", ".glb", ".dae",  ".3mf",
                                     ".fbx", ".3ds", ".step", ".stp", ".iges", ".igs", ".brep", ".brp"};

std::string random_id() {
  std::random_device source;
  std::string out;
  for (int i = 0; i < 4; ++i) {
    std::array<char, 9> digits{};
    std::snprintf(digits.data(), digits.size(), "%08x", source());
    out += digits.data();
  }
  return out;
}

ordered_json json_of(const Vec3& v) { return {v.x, v.y, v.z}; }

/// The box of a run of triangles; null for none.
ordered_json box_of(const Mesh& mesh, std::uint32_t first, std::uint32_t count) {
  if (count == 0) return nullptr;
  Vec3 low(INFINITY), high(-INFINITY);
  for (std::uint32_t t = first; t < first + count; ++t)
    for (const std::uint32_t v : mesh.triangles[t]) {
      low = glm::min(low, mesh.vertices[v]);
      high = glm::max(high, mesh.vertices[v]);
    }
  return {{"min", json_of(low)}, {"max", json_of(high)}};
}

/// Puts `more` behind what `to` has.
void append(Mesh& to, const Mesh& more) {
  const auto vertices = static_cast<std::uint32_t>(to.vertices.size());
  const auto triangles = static_cast<std::uint32_t>(to.triangles.size());
  to.vertices.insert(to.vertices.end(), more.vertices.begin(), more.vertices.end());
  for (auto triangle : more.triangles) {
    for (std::uint32_t& v : triangle) v += vertices;
    to.triangles.push_back(triangle);
  }
  for (MeshPart part : more.parts) {
    part.first_triangle += triangles;
    to.parts.push_back(std::move(part));
  }
}

ordered_json parts_json(const Assembly& assembly) {
  ordered_json parts = ordered_json::array();
  for (std::size_t i = 0; i < assembly.mesh.parts.size(); ++i) {
    const MeshPart& part = assembly.mesh.parts[i];
    std::array<char, 8> colour{};
    if (part.colour) std::snprintf(colour.data(), colour.size(), "#%06x", *part.colour & 0xffffffu);
    parts.push_back({{"file", assembly.file_of_part[i]},
                     {"path", part.path},
                     {"also", part.also},
                     {"first_triangle", part.first_triangle},
                     {"triangles", part.triangle_count},
                     {"colour", part.colour ? ordered_json(colour.data()) : ordered_json()},
                     {"box", box_of(assembly.mesh, part.first_triangle, part.triangle_count)}});
  }
  return parts;
}

}  // namespace

bool is_mesh_name(const std::string& name) {
  std::string ending = fs::path(name).extension().string();
  for (char& c : ending) c = static_cast<char>(std::tolower(static_cast<unsigned char>(c)));
  return std::find(kMeshEndings.begin(), kMeshEndings.end(), ending) != kMeshEndings.end();
}

struct AssemblyStore::Entry {
  enum class State : std::uint8_t { kReading, kReady, kFailed } state = State::kReading;
  std::shared_ptr<Assembly> assembly = std::make_shared<Assembly>();
  std::string step = "waiting";
  double progress = 0;
  std::optional<Problem> error;
  std::string parts = "[]";  ///< JSON, made once
  std::uint64_t bytes = 0;
  std::atomic<bool> removed{false};
};

AssemblyStore::AssemblyStore(const ServerLimits& limits)
    : limits_(limits), thread_([this] { read_loop(); }) {}

AssemblyStore::~AssemblyStore() {
  stop_ = true;
  {
    const std::lock_guard lock(mutex_);
    work_.notify_all();
  }
  thread_.join();
}

std::string AssemblyStore::add(std::shared_ptr<SpoolFolder> folder, std::vector<AssemblyFile> files) {
  auto entry = std::make_shared<Entry>();
  entry->assembly->id = random_id();
  entry->assembly->folder = std::move(folder);
  for (const AssemblyFile& file : files) entry->bytes += file.bytes;
  entry->assembly->files = std::move(files);
  std::list<std::shared_ptr<Entry>> garbage;  // folders are removed without the lock
  const std::lock_guard lock(mutex_);
  entries_.push_back(entry);
  queue_.push_back(entry);
  std::uint64_t sum = 0;
  for (const auto& known : entries_) sum += known->bytes;
  while (entries_.size() > 1 && (entries_.size() > kMost || sum > limits_.disk_bytes)) {
    sum -= entries_.front()->bytes;
    entries_.front()->removed = true;
    garbage.splice(garbage.end(), entries_, entries_.begin());
  }
  work_.notify_all();
  return json_locked(*entry);
}

std::shared_ptr<AssemblyStore::Entry> AssemblyStore::find_locked(const std::string& id) const {
  const auto found = std::find_if(entries_.begin(), entries_.end(),
                                  [&](const auto& entry) { return entry->assembly->id == id; });
  return found == entries_.end() ? nullptr : *found;
}

std::optional<std::string> AssemblyStore::json(const std::string& id) const {
  const std::lock_guard lock(mutex_);
  const auto entry = find_locked(id);
  if (!entry) return std::nullopt;
  return json_locked(*entry);
}

std::string AssemblyStore::json_locked(const Entry& entry) const {
  const Assembly& assembly = *entry.assembly;
  const bool ready = entry.state == Entry::State::kReady;
  ordered_json files = ordered_json::array();
  for (const AssemblyFile& file : assembly.files)
    files.push_back({{"name", file.name},
                     {"bytes", file.bytes},
                     {"mesh", file.mesh},
                     {"states_unit", file.mesh && states_unit(file.name)},
                     {"in_metres", file.mesh && comes_in_metres(file.name)},
                     {"triangles", ready ? ordered_json(file.triangles) : ordered_json()},
                     {"error", file.error.empty() ? ordered_json() : ordered_json(file.error)},
                     {"notes", file.notes}});
  ordered_json out = {{"id", assembly.id},
                      {"state", ready                                   ? "ready"
                                : entry.state == Entry::State::kReading ? "reading"
                                                                        : "failed"},
                      {"step", entry.step},
                      {"progress", entry.progress},
                      {"error", entry.error ? ordered_json::parse(entry.error->json()) : ordered_json()},
                      {"files", std::move(files)}};
  std::string text = dump(out);
  text.pop_back();
  return text + ",\"parts\":" + entry.parts + "}";
}

std::variant<std::shared_ptr<const Assembly>, Problem> AssemblyStore::ready(const std::string& id) const {
  const std::lock_guard lock(mutex_);
  const auto entry = find_locked(id);
  if (!entry) return Problem{404, "not-found", "there is no assembly " + shown_text(id), "id"};
  if (entry->state == Entry::State::kFailed) return *entry->error;
  if (entry->state == Entry::State::kReading)
    return Problem{409, "conflict", "the assembly is still being read", "id"};
  return std::shared_ptr<const Assembly>(entry->assembly);
}

bool AssemblyStore::remove(const std::string& id) {
  std::shared_ptr<Entry> gone;
  const std::lock_guard lock(mutex_);
  gone = find_locked(id);
  if (!gone) return false;
  gone->removed = true;
  entries_.remove(gone);
  return true;
}

void AssemblyStore::read_loop() {
  for (;;) {
    std::shared_ptr<Entry> entry;
    {
      std::unique_lock lock(mutex_);
      work_.wait(lock, [&] { return stop_ || !queue_.empty(); });
      if (stop_) return;
      entry = queue_.front();
      queue_.pop_front();
    }
    if (!entry->removed) read(*entry);
  }
}

void AssemblyStore::read(Entry& entry) {
  // Nobody else changes the assembly until it is ready; its files are copied, for json() looks at them
  // meanwhile.
  Assembly& assembly = *entry.assembly;
  std::vector<AssemblyFile> files = assembly.files;
  Mesh mesh;
  std::vector<std::uint32_t> file_of_part;
  const auto meshes = std::count_if(files.begin(), files.end(), [](const auto& file) { return file.mesh; });
  double done = 0;
  std::string last_error;
  for (std::size_t i = 0; i < files.size() && !stop_ && !entry.removed; ++i) {
    AssemblyFile& file = files[i];
    if (!file.mesh) continue;
    ImportReport report;
    const auto read =
        import_mesh_below(assembly.folder->path().string(), (assembly.folder->path() / file.name).string(), 1,
                          report, {}, [&](const char* what, double part) {
                            const std::lock_guard lock(mutex_);
                            entry.step = file.name + ": " + what;
                            entry.progress = (done + part) / static_cast<double>(meshes);
                            return !stop_ && !entry.removed;
                          });
    done += 1;
    if (!read) {
      file.error = without_folder(read.error().sentence, assembly.folder->path());
      last_error = file.error;
      continue;
    }
    file.notes = report.notes;
    if (mesh.triangles.size() + read->triangles.size() > limits_.triangles) {
      file.error = "with it the assembly has more than " + std::to_string(limits_.triangles) + " triangles";
      last_error = file.error;
      continue;
    }
    file.first_triangle = static_cast<std::uint32_t>(mesh.triangles.size());
    file.triangles = static_cast<std::uint32_t>(read->triangles.size());
    append(mesh, *read);
    file_of_part.resize(mesh.parts.size(), static_cast<std::uint32_t>(i));
  }
  const std::lock_guard lock(mutex_);
  assembly.files = std::move(files);
  if (mesh.parts.empty() || mesh.parts.size() > kMostParts) {
    entry.error = mesh.parts.empty()
                      ? bad_request(last_error.empty() ? "none of these files is a mesh" : last_error, "file")
                      : Problem{413, "too-large",
                                "the assembly has " + std::to_string(mesh.parts.size()) + " parts, at most " +
                                    std::to_string(kMostParts) + " are taken",
                                "file"};
    entry.state = Entry::State::kFailed;
    return;
  }
  assembly.mesh = std::move(mesh);
  assembly.file_of_part = std::move(file_of_part);
  entry.parts = dump(parts_json(assembly));
  entry.progress = 1;
  entry.step = "ready";
  entry.state = Entry::State::kReady;
}

}  // namespace palpate

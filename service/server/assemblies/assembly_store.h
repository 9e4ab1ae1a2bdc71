#pragma once
#include <atomic>
#include <condition_variable>
#include <cstdint>
#include <list>
#include <memory>
#include <mutex>
#include <optional>
#include <string>
#include <thread>
#include <vector>

#include "model/mesh/mesh.h"
#include "service/server/http/limits.h"
#include "service/server/http/problem.h"
#include "service/server/scenes/spool_files.h"

namespace palpate {

/// A file of an assembly. Those that are no mesh (a glTF's buffers, an OBJ's materials) are kept for the
/// others to draw on.
struct AssemblyFile {
  std::string name;  ///< a plain name (safe_path.h)
  std::uint64_t bytes = 0;
  bool mesh = false;
  std::string error = {};                           ///< why it could not be read; empty: it was, or will be
  std::vector<std::string> notes = {};              ///< ImportReport::notes
  std::uint32_t first_triangle = 0, triangles = 0;  ///< in Assembly::mesh
};

/// Mesh files that were uploaded together, to be looked at before there is a scene.
struct Assembly {
  std::string id;  ///< 32 hexadecimal digits, by chance: who knows it may use it
  std::shared_ptr<SpoolFolder> folder;
  std::vector<AssemblyFile> files;
  Mesh mesh;  ///< all of them, in file units; metres where a file states its unit
  std::vector<std::uint32_t> file_of_part;  ///< place in `files`
};

/// Whether an uploaded file is read as a mesh, by its ending; the others are its company.
bool is_mesh_name(const std::string& name);

/// The assemblies of a server. They are read one after the other on a thread of its own; the oldest goes when
/// there are more than kMost, or more bytes than ServerLimits::disk_bytes. Any thread may call anything.
class AssemblyStore {
 public:
  static constexpr std::size_t kMost = 8;            ///< chosen
  static constexpr std::size_t kMostParts = 20'000;  ///< chosen: what a list of parts can show

  explicit AssemblyStore(const ServerLimits& limits);
  ~AssemblyStore();
  AssemblyStore(const AssemblyStore&) = delete;
  AssemblyStore& operator=(const AssemblyStore&) = delete;

  /// Takes what was uploaded; the answer is the Assembly's JSON (docs/SERVICE.md).
  std::string add(std::shared_ptr<SpoolFolder> folder, std::vector<AssemblyFile> files);
  std::optional<std::string> json(const std::string& id) const;
  /// Problem: there is none of this name, or it is not ready.
  std::variant<std::shared_ptr<const Assembly>, Problem> ready(const std::string& id) const;
  bool remove(const std::string& id);

 private:
  struct Entry;
  void read_loop();
  void read(Entry& entry);
  std::shared_ptr<Entry> find_locked(const std::string& id) const;
  std::string json_locked(const Entry& entry) const;

  ServerLimits limits_;
  mutable std::mutex mutex_;
  std::condition_variable work_;
  std::list<std::shared_ptr<Entry>> entries_;  ///< oldest first
  std::list<std::shared_ptr<Entry>> queue_;
  std::atomic<bool> stop_{false};
  std::thread thread_;
};

}  // namespace palpate

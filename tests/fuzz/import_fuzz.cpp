// The whole import in one process, assimp included, of the formats that we check before: a sound mesh or one
// sentence. The format is told from the first bytes, so that the corpus holds files as they are. Others crash
// assimp at once; see contained_fuzz.cpp.
#include <sys/stat.h>
#include <unistd.h>

#include <cmath>
#include <cstdlib>
#include <string>
#include <string_view>

#include "model/import/mesh_read.h"
#include "tests/fuzz/fuzz_target.h"
#include "tests/fuzz/input_file.h"
#include "tests/model/temporary_folder.h"

/// Where assimp gives up in the middle it forgets what it had; leaks of ours are reported.
extern "C" const char* __lsan_default_suppressions();
extern "C" const char* __lsan_default_suppressions() { return "leak:libassimp"; }

namespace {

std::string_view extension_of(std::string_view bytes) {
  const auto begins = [&](std::string_view start) { return bytes.substr(0, start.size()) == start; };
  if (begins("glTF")) return ".glb";
  if (begins("{")) return ".gltf";
  if (begins("ply")) return ".ply";
  if (begins("<")) return ".dae";
  if (bytes.substr(0, 16).find("OFF") != std::string_view::npos) return ".off";
  if (begins("v ") || begins("#") || begins("o ") || begins("mtllib")) return ".obj";
  return ".stl";
}

/// A link with the extension to the file in memory: the importer goes by names.
std::string linked(const palpate::InputFile& file, std::string_view extension) {
  static const palpate::TemporaryFolder folder;
  const std::string link = folder.path("input" + std::string(extension));
  struct stat status {};
  if (::lstat(link.c_str(), &status) != 0 && ::symlink(file.path().c_str(), link.c_str()) != 0) std::abort();
  return link;
}

}  // namespace

int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace palpate;
  static InputFile file;
  file.write(data, size);
  const std::string path = linked(file, extension_of({reinterpret_cast<const char*>(data), size}));
  ImportReport report;
  const Result<Mesh> mesh = read_mesh(path, 0.001, report);
  if (!mesh) {
    PALPATE_PROMISE(mesh.error().code == ErrorCode::kBadValue &&
                    mesh.error().sentence.find(path) != std::string::npos);
    return 0;
  }
  PALPATE_PROMISE(!mesh->triangles.empty() && !mesh->parts.empty());
  for (const auto& triangle : mesh->triangles)
    for (const std::uint32_t vertex : triangle)
      PALPATE_PROMISE(vertex < mesh->vertices.size() && std::isfinite(mesh->vertices[vertex].x));
  return 0;
}

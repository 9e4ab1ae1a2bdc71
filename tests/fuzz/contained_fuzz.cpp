// Formats that nothing of ours checks before assimp (3MF, FBX), through palpate-import: whatever happens to
// it, a sound mesh or one sentence.
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <string_view>

#include "model/mesh/mesh_import.h"
#include "tests/fuzz/fuzz_target.h"
#include "tests/model/temporary_folder.h"

int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace palpate;
  static const TemporaryFolder folder;
  const std::string_view bytes(reinterpret_cast<const char*>(data), size);
  const std::string path = folder.write(bytes.substr(0, 2) == "PK" ? "input.3mf" : "input.fbx", bytes);
  ImportReport report;
  const Result<Mesh> mesh = import_mesh(path, 0.001, report, {.memory_bytes = 512u << 20, .seconds = 5});
  if (mesh)
    PALPATE_PROMISE(!mesh->triangles.empty());
  else
    PALPATE_PROMISE(mesh.error().code == ErrorCode::kBadValue &&
                    mesh.error().sentence.find(path) != std::string::npos);
  return 0;
}

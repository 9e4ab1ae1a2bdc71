// STEP, IGES and BREP through palpate-import-cad: whatever happens to OpenCASCADE, a sound mesh or one
// sentence.
#include <string_view>

#include "model/mesh/mesh_import.h"
#include "tests/fuzz/fuzz_target.h"
#include "tests/model/temporary_folder.h"

int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace palpate;
  static const TemporaryFolder folder;
  const std::string_view bytes(reinterpret_cast<const char*>(data), size), head = bytes.substr(0, 100);
  const std::string path =
      folder.write(head.find("CASCADE") != head.npos || head.starts_with("DBRep") ? "input.brep"
                   : head.starts_with("    ")                                     ? "input.igs"
                                                                                  : "input.step",
                   bytes);
  ImportReport report;
  const Result<Mesh> mesh = import_mesh(path, 0.001, report, {.memory_bytes = 1u << 30, .seconds = 2});
  if (mesh)
    PALPATE_PROMISE(!mesh->triangles.empty());
  else
    PALPATE_PROMISE(mesh.error().code == ErrorCode::kBadValue &&
                    mesh.error().sentence.find(path) != std::string::npos);
  return 0;
}

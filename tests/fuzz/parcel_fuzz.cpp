// What palpate-import hands back, were it to go mad: a sound mesh, or an error; and a sound mesh can be sent
// again.
#include <cmath>

#include "model/import/mesh_parcel.h"
#include "tests/fuzz/fuzz_target.h"
#include "tests/fuzz/input_file.h"

int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace palpate;
  static InputFile file, again;
  file.write(data, size);
  ImportReport report;
  const Result<Mesh> mesh = read_parcel(file.descriptor(), report);
  if (!mesh) {
    PALPATE_PROMISE(!mesh.error().sentence.empty());
    return 0;
  }
  for (const auto& triangle : mesh->triangles)
    for (const std::uint32_t vertex : triangle) PALPATE_PROMISE(vertex < mesh->vertices.size());
  again.write(data, 0);
  PALPATE_PROMISE(write_parcel(again.descriptor(), mesh, report));
  ImportReport second;
  const Result<Mesh> same = read_parcel(again.descriptor(), second);
  PALPATE_PROMISE(same && same->triangles == mesh->triangles && same->vertices == mesh->vertices &&
                  second.notes == report.notes);
  return 0;
}

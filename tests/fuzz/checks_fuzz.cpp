// The checks before the importer, every one on every input: nothing, or the rest of a sentence; in time and
// memory that the input's own size bounds (libFuzzer's limits hold that).
#include <string_view>

#include "model/import/import_checks.h"
#include "tests/fuzz/fuzz_target.h"

int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace palpate;
  const std::string_view bytes(reinterpret_cast<const char*>(data), size);
  for (const std::string& wrong :
       {distrust_stl(bytes), distrust_off(bytes), distrust_ply(bytes),
        distrust_gltf(bytes, "/nowhere/input.gltf"), distrust_dae(bytes), distrust_obj(bytes)})
    PALPATE_PROMISE(wrong.size() < 500);
  return 0;
}

// Scene files: a Scene within the stated limits, or one sentence.
#include "model/scene/scene_file.h"
#include "tests/fuzz/fuzz_target.h"
#include "tests/fuzz/input_file.h"

int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  static palpate::InputFile file;
  file.write(data, size);
  const auto scene = palpate::read_scene(file.path());
  if (scene) {
    PALPATE_PROMISE(!scene->statics.empty());
    PALPATE_PROMISE(scene->response.stiffness_n_per_m >= 0 && scene->response.stiffness_n_per_m <= 1e6);
    PALPATE_PROMISE(scene->tool.mass_kg > 0 && scene->device.max_force_n <= 1e3);
    PALPATE_PROMISE(scene->control.watchdog_ms >= 0);
  } else {
    PALPATE_PROMISE(scene.error().code == palpate::ErrorCode::kBadValue && !scene.error().sentence.empty());
    for (const char c : scene.error().sentence)
      PALPATE_PROMISE(static_cast<unsigned char>(c) >= 0x20 && c != 0x7f);  // a terminal shows it
  }
  return 0;
}

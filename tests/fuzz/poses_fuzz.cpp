// Poses, the hand's path and a guide (CSV), and the pose of a command line: finite numbers and unit
// rotations, or one sentence.
#include <cmath>

#include "model/files/path_file.h"
#include "service/cli/pose_input.h"
#include "tests/fuzz/fuzz_target.h"
#include "tests/fuzz/input_file.h"

namespace {

using namespace palpate;

void expect_sound(const Pose& pose) {
  for (int k = 0; k < 3; ++k) PALPATE_PROMISE(std::isfinite(pose.position[k]));
  PALPATE_PROMISE(std::abs(glm::length(pose.rotation) - 1) < 2e-3);
}

template <class T>
void expect_sentence(const Result<T>& result) {
  PALPATE_PROMISE(result.error().code == ErrorCode::kBadValue && !result.error().sentence.empty());
  for (const char c : result.error().sentence)
    PALPATE_PROMISE(static_cast<unsigned char>(c) >= 0x20 && c != 0x7f);  // a terminal shows it
}

}  // namespace

int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  static InputFile file;
  file.write(data, size);
  if (const auto poses = read_poses(file.path()))
    for (const Pose& pose : *poses) expect_sound(pose);
  else
    expect_sentence(poses);
  for (const bool guided : {false, true})
    if (const auto path = read_path(file.path(), guided)) {
      for (std::size_t i = 0; i < path->size(); ++i) {
        expect_sound((*path)[i].pose);
        PALPATE_PROMISE(i == 0 || (*path)[i].time_s > (*path)[i - 1].time_s);
      }
      file.write(reinterpret_cast<const std::uint8_t*>(path_text(*path, guided).data()),
                 path_text(*path, guided).size());
      PALPATE_PROMISE(read_path(file.path(), guided));  // what is written can be read
      file.write(data, size);
    } else {
      expect_sentence(path);
    }
  if (const auto guide = read_guide(file.path())) {
    for (const GuidePoint& point : *guide) expect_sound(point.frame);
    for (const double travel : {-1.0, 0.0, 0.01, 1e4}) expect_sound(guide_frame(*guide, travel));
  } else {
    expect_sentence(guide);
  }
  const auto pose = parse_pose(std::string(reinterpret_cast<const char*>(data), size));
  if (pose)
    expect_sound(*pose);
  else
    expect_sentence(pose);
  return 0;
}

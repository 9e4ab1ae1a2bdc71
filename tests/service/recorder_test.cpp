#include "service/loop/recorder.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>

namespace palpate {
namespace {

using testing::HasSubstr;

TEST(Recorder, NamesADirectoryThatItCannotMake) {
  const auto file = std::filesystem::path(testing::TempDir()) / "palpate_not_a_directory";
  std::ofstream(file) << "x";
  const auto made = Recorder::create((file / "run").string());
  ASSERT_FALSE(made);
  EXPECT_THAT(made.error().sentence, HasSubstr("palpate_not_a_directory"));
  std::filesystem::remove(file);
}

TEST(Recorder, SaysThatTheDiskIsFull) {
  const auto root = std::filesystem::path(testing::TempDir()) / "palpate_full_disk";
  std::filesystem::create_directories(root);
  std::filesystem::remove(root / "trace.csv");
  std::filesystem::create_symlink("/dev/full", root / "trace.csv");  // accepts an open, refuses every byte
  auto recorder = Recorder::create(root.string());
  ASSERT_TRUE(recorder);
  Result<void> failed;
  for (int i = 0; i < 10000 && failed; ++i) failed = (*recorder)->on_tick({});
  ASSERT_FALSE(failed);
  EXPECT_THAT(failed.error().sentence, HasSubstr("No space left"));
  std::filesystem::remove_all(root);
}

TEST(Recorder, SaysThatTheDiskIsFullAtTheLatestWhenItFinishes) {
  const auto root = std::filesystem::path(testing::TempDir()) / "palpate_full_disk_2";
  std::filesystem::create_directories(root);
  std::filesystem::create_symlink("/dev/full", root / "frames.jsonl");
  auto recorder = Recorder::create(root.string());
  ASSERT_TRUE(recorder);
  ASSERT_TRUE((*recorder)->on_frame({0, Pose{}, LatticePose{}, Contacts{}, ContactResponse{}, 0}));
  const auto finished = (*recorder)->finish();
  ASSERT_FALSE(finished);
  EXPECT_THAT(finished.error().sentence, HasSubstr("frames.jsonl"));
  std::filesystem::remove_all(root);
}

}  // namespace
}  // namespace palpate

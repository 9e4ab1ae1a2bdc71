// Which engine `--backend auto` takes, with engines that take as long as they are told.
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <unistd.h>

#include <chrono>
#include <filesystem>
#include <fstream>
#include <string>
#include <thread>
#include <vector>

#include "service/cli/scene_host.h"
#include "tests/service/half_space.h"

namespace palpate {
namespace {

using testing::Contains;
using testing::HasSubstr;
using testing::Not;
using namespace std::chrono_literals;

constexpr auto kLong = 50ms;  // the other engine is asked thrice in less, however busy the machine

/// An engine by another name.
class Named final : public HalfSpace {
 public:
  Named(std::string name, std::chrono::milliseconds frame, int& prepared)
      : name_(std::move(name)), prepared_(prepared) {
    on_query = [frame](int) -> Result<void> {
      std::this_thread::sleep_for(frame);
      return {};
    };
  }
  Result<void> prepare(const SceneGeometry&, const Plan&, const Progress&) override {
    ++prepared_;
    return fails ? Result<void>(Error{ErrorCode::kInternal, "no memory here"}) : Result<void>();
  }
  std::string name() const override { return name_; }

  bool fails = false;

 private:
  const std::string name_;
  int& prepared_;
};

class EngineChoice : public testing::Test {
 protected:
  EngineChoice()
      : file_(std::filesystem::temp_directory_path() /
              ("palpate_engine_choice_" + std::to_string(::getpid()) + ".json")) {
    std::ofstream(file_)
        << R"({"static":[{"generate":{"name":"contacts","body":"mockup","triangles":2000}}],)"
           R"("tool":{"generate":{"name":"contacts","body":"tool","triangles":1000}}})";
    parts_.has_gpu = [this] { return has_gpu_; };
    parts_.make_gpu = [this](bool) -> Result<std::unique_ptr<CollisionBackend>> {
      return std::unique_ptr<CollisionBackend>(std::make_unique<Named>("gpu", gpu_frame_, prepared_gpu_));
    };
    parts_.make_cpu = [this](bool) {
      auto made = std::make_unique<Named>("cpu", cpu_frame_, prepared_cpu_);
      made->fails = cpu_fails_;
      return made;
    };
    parts_.make_ref = [this] { return std::make_unique<Named>("ref", 0ms, prepared_ref_); };
  }
  ~EngineChoice() override { std::filesystem::remove(file_); }

  std::string taken(const std::string& backend) {
    SceneOptions options;
    options.scene = file_.string();
    options.backend = backend;
    auto prepared = prepare_scene(
        options, Purpose::kQuery, parts_,
        PrepareWatch{.note = [this](const std::string& sentence) { notes_.push_back(sentence); },
                     .step = [](const char*) {},
                     .progress = {},
                     .admit = {},
                     .cached = false,
                     .folder = {}});
    EXPECT_TRUE(prepared) << prepared.error().sentence;
    return prepared ? (*prepared)->backend->name() : "";
  }

  const std::filesystem::path file_;
  Parts parts_;
  bool has_gpu_ = true, cpu_fails_ = false;
  std::chrono::milliseconds gpu_frame_{0}, cpu_frame_{0};
  int prepared_gpu_ = 0, prepared_cpu_ = 0, prepared_ref_ = 0;
  std::vector<std::string> notes_;
};

TEST_F(EngineChoice, TheProcessorAnswersWhereItIsQuickerThanTheGpu) {
  gpu_frame_ = kLong;
  EXPECT_EQ(taken("auto"), "cpu");
  EXPECT_THAT(notes_, Contains(HasSubstr("the engine cpu answers: a frame near the start, gpu ")));
  EXPECT_THAT(notes_, Contains(HasSubstr("cpu is the quicker by a factor of ")));
}

TEST_F(EngineChoice, TheGpuAnswersWhereItIsQuicker) {
  cpu_frame_ = kLong;
  EXPECT_EQ(taken(""), "gpu");
  EXPECT_THAT(notes_, Contains(HasSubstr("the engine gpu answers: a frame near the start, gpu ")));
}

TEST_F(EngineChoice, NothingIsMeasuredWithoutAGpu) {
  has_gpu_ = false;
  EXPECT_EQ(taken("auto"), "cpu");
  EXPECT_EQ(prepared_gpu_, 0);
  EXPECT_EQ(prepared_cpu_, 1);
  EXPECT_THAT(notes_, Not(Contains(HasSubstr("near the start"))));
}

TEST_F(EngineChoice, WhoNamesAnEngineGetsIt) {
  gpu_frame_ = kLong;
  EXPECT_EQ(taken("gpu"), "gpu");
  EXPECT_EQ(prepared_cpu_, 0);
}

TEST_F(EngineChoice, TheGpuStaysWhereTheOtherCannotBeMeasured) {
  gpu_frame_ = kLong;
  cpu_fails_ = true;
  EXPECT_EQ(taken("auto"), "gpu");
  EXPECT_THAT(notes_,
              Contains(HasSubstr("it was not measured beside cpu: that engine can't prepare the scene")));
}

}  // namespace
}  // namespace palpate

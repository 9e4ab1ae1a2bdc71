// The device runs out of memory, or is lost, at any moment: one sentence, and what can go on goes on.
#include <gmock/gmock.h>

#include "tests/faults/fault_scene.h"

namespace palpate {
namespace {

using testing::AllOf;
using testing::HasSubstr;
using Call = GpuFault::Call;

class DeviceFaults : public testing::Test {
 protected:
  void SetUp() override {
    scene = ball_on_edge();
    GpuOptions options;
    options.validation = true;
    options.fault = fault;
    options.first_capacity = {{"pairs", 1}};
    auto made = make_gpu_backend(options);
    ASSERT_TRUE(made) << made.error().sentence;
    backend = std::move(*made);
  }
  void fail(Call call, std::int64_t after = 0) {
    fault->after = after;
    fault->call = call;
  }
  std::string prepare_sentence() {
    const auto prepared = prepare(*backend, *scene);
    return prepared ? "" : prepared.error().sentence;
  }

  std::unique_ptr<FaultScene> scene;
  std::shared_ptr<GpuFault> fault = std::make_shared<GpuFault>();
  std::unique_ptr<CollisionBackend> backend;
  Contacts out;
};

TEST_F(DeviceFaults, OutOfMemoryAtAnyBufferIsOneSentenceWithBytesNeededAndThere) {
  bool done = false;
  int refusals = 0;
  for (std::int64_t after = 0; !done; after = after * 5 / 4 + 1) {
    fail(Call::kAllocate, after);
    const auto prepared = prepare(*backend, *scene);
    done = static_cast<bool>(prepared);
    if (done) continue;
    ++refusals;
    EXPECT_EQ(prepared.error().code, ErrorCode::kInternal);
    EXPECT_THAT(prepared.error().sentence,
                AllOf(HasSubstr(" need "), HasSubstr(" MiB beside "), HasSubstr("in use"),
                      HasSubstr("of memory"), HasSubstr("out of device memory")));
    EXPECT_FALSE(backend->query(scene->pose, nullptr, out)) << "what isn't prepared doesn't answer";
  }
  EXPECT_GT(refusals, 10);
  fail(Call::kNone);
  ASSERT_EQ(prepare_sentence(), "");
  ASSERT_TRUE(backend->query(scene->pose, nullptr, out));
  EXPECT_TRUE(out.truncated);
}

TEST_F(DeviceFaults, WithoutMemoryToGrowAFrameStaysTruncatedAndOthersAreAnswered) {
  ASSERT_EQ(prepare_sentence(), "");
  ASSERT_TRUE(backend->query(scene->pose, nullptr, out));
  ASSERT_STREQ(out.truncated_capacity, "pairs");
  fail(Call::kAllocate);
  const auto refused = backend->enlarge();
  ASSERT_FALSE(refused);
  EXPECT_THAT(refused.error().sentence, HasSubstr("pairs need "));
  ASSERT_TRUE(backend->query(scene->pose, nullptr, out));
  EXPECT_STREQ(out.truncated_capacity, "pairs");
  ASSERT_TRUE(backend->query(at(*scene, Vec3(0, 0, 0.05)), nullptr, out));
  EXPECT_FALSE(out.truncated);
  fail(Call::kNone);
  ASSERT_TRUE(backend->query(scene->pose, nullptr, out));
  while (out.truncated) {
    ASSERT_TRUE(backend->enlarge());
    ASSERT_TRUE(backend->query(scene->pose, nullptr, out));
  }
  EXPECT_EQ(first_difference(out, scene->expected), "");
}

TEST_F(DeviceFaults, ALostDeviceIsAnErrorOfPreparationAndOfAQuery) {
  for (const Call call : {Call::kSubmit, Call::kWait}) {
    for (const std::int64_t after : {0, 3, 40}) {
      fail(call, after);
      EXPECT_THAT(prepare_sentence(), HasSubstr("the device was lost")) << after;
    }
    fail(Call::kNone);
    ASSERT_EQ(prepare_sentence(), "");
    fail(call);
    const auto answered = backend->query(scene->pose, nullptr, out);
    ASSERT_FALSE(answered);
    EXPECT_EQ(answered.error().code, ErrorCode::kInternal);
    EXPECT_THAT(answered.error().sentence, HasSubstr("the device was lost"));
  }
}

TEST_F(DeviceFaults, APoseThatCannotTouchIsAnsweredWithoutTheDevice) {
  ASSERT_EQ(prepare_sentence(), "");
  fail(Call::kSubmit);  // whatever is submitted fails
  for (const Vec3 far : {Vec3(0, 0, 0.05), Vec3(3, 0, 0), Vec3(0, -1e6, 0)}) {
    const auto answered = backend->query(at(*scene, far), nullptr, out);
    ASSERT_TRUE(answered) << answered.error().sentence;
    EXPECT_FALSE(out.contact);
    EXPECT_FALSE(out.truncated);
  }
}

}  // namespace
}  // namespace palpate

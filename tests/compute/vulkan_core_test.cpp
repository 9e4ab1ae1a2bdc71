#include <cstdlib>
#include <string>

#include "compute/gpu/host_copy.h"
#include "tests/compute/code.h"
#include "tests/compute/gpu_test.h"

namespace palpate {
namespace {

class VulkanCore : public GpuTest {
 protected:
  VulkanBuffer buffer(std::uint64_t bytes) {
    auto made = VulkanBuffer::create(device(), "test numbers", bytes, BufferKind::kDevice);
    EXPECT_TRUE(made) << made.error().sentence;
    return std::move(*made);
  }
  ComputePipeline increment() {
    auto made = ComputePipeline::create(device(), spirv::probe_increment, 2, 4);
    EXPECT_TRUE(made) << made.error().sentence;
    return std::move(*made);
  }
  CommandRecorder recorder(std::uint32_t stages = 0) {
    auto made = CommandRecorder::create(device(), stages);
    EXPECT_TRUE(made) << made.error().sentence;
    return std::move(*made);
  }
};

// On a device with memory of its own: all who read a buffer have one copy, and one that is longer than it is
// made anew.
TEST(HostCopy, IsOneForAllWhoReadABuffer) {
  DeviceOptions options;
  options.own_memory = true;
  const auto device = VulkanDevice::create(options);
  ASSERT_TRUE(device) << device.error().sentence;
  const auto buffer = VulkanBuffer::create(**device, "test numbers", 400, BufferKind::kDevice);
  ASSERT_TRUE(buffer);
  ASSERT_EQ(buffer->as<std::uint32_t>(), nullptr) << "it is mapped: nothing would be copied";
  std::vector<std::uint32_t> numbers(100);
  for (std::uint32_t i = 0; i < numbers.size(); ++i) numbers[i] = 7 * i;
  ASSERT_TRUE(upload(**device, *buffer, numbers.data(), 400));
  HostCopy<std::uint32_t> few, all, again;
  ASSERT_TRUE(few.read(**device, *buffer, 3));
  ASSERT_TRUE(all.read(**device, *buffer, 100));
  ASSERT_TRUE(again.read(**device, *buffer, 100));
  EXPECT_EQ(all.all().data(), again.all().data());
  for (std::uint32_t i = 0; i < numbers.size(); ++i) ASSERT_EQ(again.all()[i], 7 * i);
  EXPECT_EQ(few.all()[2], 14u);
}

TEST_F(VulkanCore, ARecordedSequenceCanBeSubmittedAgain) {
  constexpr std::uint32_t kCount = 1000;
  const VulkanBuffer a = buffer(kCount * 4), b = buffer(kCount * 4);
  const ComputePipeline add = increment();
  CommandRecorder commands = recorder(2);
  commands.begin();
  commands.stage("there");
  commands.dispatch_items(add, {a, b}, kCount, kCount);
  commands.barrier();
  commands.stage("back");
  commands.dispatch_items(add, {b, a}, kCount, kCount);
  ASSERT_TRUE(commands.end());
  const std::vector<std::uint32_t> zero(kCount, 0);
  ASSERT_TRUE(upload(device(), a, zero.data(), kCount * 4));
  for (int i = 0; i < 3; ++i) {
    ASSERT_TRUE(commands.submit());
    const auto done = commands.wait();
    ASSERT_TRUE(done) << done.error().sentence;
  }
  std::vector<std::uint32_t> out(kCount);
  ASSERT_TRUE(download(device(), a, 0, out.data(), kCount * 4));
  EXPECT_EQ(out, std::vector<std::uint32_t>(kCount, 6));
  std::vector<CommandRecorder::StageTime> times;
  ASSERT_TRUE(commands.times(times));
  ASSERT_EQ(times.size(), 2u);
  EXPECT_STREQ(times[1].name, "back");
  EXPECT_GE(times[0].us, 0);
}

TEST_F(VulkanCore, MoreItemsThanWorkgroupsAlongAnAxisAllRun) {
  constexpr std::uint32_t kCount = 65535 * 64 + 100;
  const VulkanBuffer a = buffer(kCount * 4), b = buffer(kCount * 4);
  const ComputePipeline add = increment();
  CommandRecorder commands = recorder();
  commands.begin();
  commands.fill(a, 41);
  commands.fill(b, 0);
  commands.barrier();
  commands.dispatch_items(add, {a, b}, kCount, kCount);
  const auto done = commands.submit_and_wait();
  ASSERT_TRUE(done) << done.error().sentence;
  std::vector<std::uint32_t> out(kCount);
  ASSERT_TRUE(download(device(), b, 0, out.data(), out.size() * 4));
  EXPECT_EQ(out, std::vector<std::uint32_t>(kCount, 42));
}

TEST_F(VulkanCore, AForgottenBarrierFailsTheCall) {
  const VulkanBuffer a = buffer(256), b = buffer(256);
  const ComputePipeline add = increment();
  CommandRecorder commands = recorder();
  commands.begin();
  commands.fill(a, 0);
  commands.fill(b, 0);
  commands.barrier();
  commands.dispatch_items(add, {a, b}, 64u, 64);
  commands.dispatch_items(add, {b, a}, 64u, 64);  // reads what the first one writes
  const auto done = commands.submit_and_wait();
  ASSERT_FALSE(done);
  EXPECT_NE(done.error().sentence.find("SYNC-HAZARD"), std::string::npos) << done.error().sentence;
  ASSERT_TRUE(device().take_validation_error());
}

TEST_F(VulkanCore, ABufferBeyondWhatAShaderMaySeeIsRefusedInOneSentence) {
  const std::uint64_t before = device().allocated;
  auto made = VulkanBuffer::create(device(), "voxels' lists", device().limits().storage_range + 4,
                                   BufferKind::kDevice);
  ASSERT_FALSE(made);
  EXPECT_EQ(made.error().code, ErrorCode::kBadValue);
  EXPECT_EQ(made.error().sentence.rfind("voxels' lists need ", 0), 0u) << made.error().sentence;
  EXPECT_EQ(device().allocated, before);
}

/// Buffers made within are guarded.
struct Guarded {
  explicit Guarded(VulkanDevice& of) : device(of) { device.guarded = true; }
  ~Guarded() {
    device.guarded = false;
    device.guard_error.clear();
  }
  VulkanDevice& device;
};

TEST_F(VulkanCore, AShaderThatWritesWithinAGuardedBufferIsLeftAlone) {
  const Guarded guarded(device());
  const VulkanBuffer a = buffer(400), b = buffer(400);
  const ComputePipeline add = increment();
  CommandRecorder commands = recorder();
  commands.begin();
  commands.fill(a, 7);
  commands.barrier();
  commands.dispatch_items(add, {a, b}, 100u, 100);
  ASSERT_TRUE(commands.submit_and_wait());
  const auto checked = device().check_guards();
  EXPECT_TRUE(checked) << checked.error().sentence;
  std::vector<std::uint32_t> out(100);
  ASSERT_TRUE(download(device(), b, 0, out.data(), 400));
  EXPECT_EQ(out, std::vector<std::uint32_t>(100, 8));
}

TEST_F(VulkanCore, AShaderThatWritesOneEntryBehindAGuardedBufferIsFound) {
  const Guarded guarded(device());
  const VulkanBuffer a = buffer(404), b = buffer(400);
  const ComputePipeline add = increment();
  CommandRecorder commands = recorder();
  commands.begin();
  commands.fill(a, 7);
  commands.barrier();
  commands.dispatch_items(add, {a, b}, 101u, 101);
  ASSERT_TRUE(commands.submit_and_wait());
  const auto checked = device().check_guards();
  ASSERT_FALSE(checked);
  EXPECT_EQ(checked.error().sentence,
            "a buffer's guard is broken: test numbers (400 bytes): something wrote 0 bytes behind its end");
}

TEST_F(VulkanCore, AHostThatWritesBeforeAGuardedBufferIsFoundWhenItDies) {
  const Guarded guarded(device());
  {
    auto made = VulkanBuffer::create(device(), "answers", 64, BufferKind::kReadback);
    ASSERT_TRUE(made) << made.error().sentence;
    const_cast<char*>(made->as<char>())[-4] = 0;  // the only way to write it: by mistake
  }
  const auto checked = device().check_guards();
  ASSERT_FALSE(checked);
  EXPECT_EQ(checked.error().sentence,
            "a buffer's guard is broken: answers (64 bytes): something wrote 4 bytes before its start");
}

TEST_F(VulkanCore, WhatTheHostGivesADeviceItCanNotReadInPlace) {
  auto given = VulkanBuffer::create(device(), "given", 64, BufferKind::kUpload);
  ASSERT_TRUE(given) << given.error().sentence;
  EXPECT_EQ(given->as<char>(), nullptr);
  const std::uint32_t word = 0xCAFEu;
  EXPECT_TRUE(given->write(8, &word, sizeof word));
  std::uint32_t read = 0;
  ASSERT_TRUE(download(device(), *given, 8, &read, sizeof read));  // by a copy of the device's
  EXPECT_EQ(read, word);
}

TEST_F(VulkanCore, MemoryIsCountedWhileABufferLives) {
  const std::uint64_t before = device().allocated;
  {
    const VulkanBuffer a = buffer(1000);
    EXPECT_EQ(device().allocated, before + 1000);
  }
  EXPECT_EQ(device().allocated, before);
}

TEST_F(VulkanCore, TheEnvironmentIsAsTheUserSetIt) {
  const char* value = std::getenv("LP_NUM_THREADS");
  const std::string was = value != nullptr ? value : "unset";
  DeviceOptions options;
  auto other = VulkanDevice::create(options);
  ASSERT_TRUE(other);
  value = std::getenv("LP_NUM_THREADS");
  EXPECT_EQ(value != nullptr ? value : "unset", was);
}

}  // namespace
}  // namespace palpate

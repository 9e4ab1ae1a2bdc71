#pragma once
#include <gtest/gtest.h>

#include <memory>
#include <vector>

#include "compute/vulkan/buffer.h"
#include "compute/vulkan/command_recorder.h"
#include "compute/vulkan/device.h"
#include "compute/vulkan/pipeline.h"

namespace palpate {

/// A test on the device, with the validation layer on: any of its messages fails the call that caused it.
/// No device fails the test.
class GpuTest : public testing::Test {
 protected:
  static void SetUpTestSuite() {
    DeviceOptions options;
    options.validation = true;
    auto made = VulkanDevice::create(options);
    ASSERT_TRUE(made) << made.error().sentence;
    device_ = std::move(*made);
  }
  static void TearDownTestSuite() { device_.reset(); }
  void SetUp() override { ASSERT_NE(device_, nullptr); }

  /// Runs a probe: reads In[], writes Out[], one invocation an item; bindings 0 and 1; push constant: count.
  template <class Out, class In>
  std::vector<Out> run_probe(const ShaderCode& code, const std::vector<In>& in) {
    std::vector<Out> out(in.size());
    run_probe_bytes(code, in.data(), in.size() * sizeof(In), out.data(), out.size() * sizeof(Out), in.size());
    return out;
  }

  static VulkanDevice& device() { return *device_; }

 private:
  static void run_probe_bytes(const ShaderCode& code, const void* in, std::size_t in_bytes, void* out,
                              std::size_t out_bytes, std::size_t count) {
    auto pipeline = ComputePipeline::create(*device_, code, 2, 4);
    ASSERT_TRUE(pipeline) << pipeline.error().sentence;
    auto from = VulkanBuffer::create(*device_, "probe input", in_bytes, BufferKind::kUpload);
    ASSERT_TRUE(from) << from.error().sentence;
    auto to = VulkanBuffer::create(*device_, "probe output", out_bytes, BufferKind::kReadback);
    ASSERT_TRUE(to) << to.error().sentence;
    ASSERT_TRUE(upload(*device_, *from, in, in_bytes));
    auto recorder = CommandRecorder::create(*device_);
    ASSERT_TRUE(recorder);
    recorder->begin();
    recorder->dispatch_items(*pipeline, {*from, *to}, static_cast<std::uint32_t>(count), count);
    auto done = recorder->submit_and_wait();
    ASSERT_TRUE(done) << done.error().sentence;
    ASSERT_TRUE(download(*device_, *to, 0, out, out_bytes));
  }
  static inline std::unique_ptr<VulkanDevice> device_;
};

}  // namespace palpate

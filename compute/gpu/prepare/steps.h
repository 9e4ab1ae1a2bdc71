#pragma once
#include <chrono>
#include <cstdint>
#include <initializer_list>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "compute/vulkan/buffer.h"
#include "compute/vulkan/command_recorder.h"
#include "compute/vulkan/device.h"
#include "compute/vulkan/pipeline.h"
#include "model/collision_backend.h"
#include "model/result.h"

namespace palpate {

/// What the steps of preparation are written with. The first failure sticks: from then on buffers are empty,
/// run() does nothing and read() gives 0, so that a step reads straight down and its caller asks ok() once.
/// One thread.
class PrepareSteps {
 public:
  PrepareSteps(VulkanDevice& device, const Progress& progress);

  bool ok() const { return !error_.has_value(); }
  const Error& error() const { return *error_; }
  void fail(Error error);
  /// Tells the progress and fails when it cancels.
  void progress(const char* what, double done);

  /// A device buffer for `entries` entries of `entry_bytes`; contents undefined.
  VulkanBuffer buffer(const char* what, std::uint64_t entries, std::uint64_t entry_bytes = 4,
                      BufferKind kind = BufferKind::kDevice);
  /// A device buffer with the given contents.
  VulkanBuffer filled(const char* what, const void* data, std::uint64_t entries, std::uint64_t entry_bytes,
                      BufferKind kind = BufferKind::kDevice);
  template <class T>
  VulkanBuffer filled(const char* what, const std::vector<T>& data) {
    return filled(what, data.data(), data.size(), sizeof(T));
  }
  /// The same, which shaders see in texels of four words.
  VulkanBuffer texels(const char* what, const std::vector<std::uint32_t>& words) {
    return filled(what, words.data(), words.size(), 4, BufferKind::kTexels);
  }

  /// The pipeline of a shader with these constants (ids 0, 1, …); made once.
  const ComputePipeline& pipeline(const ShaderCode& code, std::uint32_t buffers, std::uint32_t push_bytes,
                                  std::initializer_list<std::uint32_t> constants = {});

  /// Records with `record(CommandRecorder&)`, submits and waits.
  template <class Record>
  void run(Record&& record) {
    if (!ok()) return;
    recorder_->begin();
    record(*recorder_);
    finish();
  }
  /// Runs one shader on `count` items.
  template <class Push>
  void run_items(const ShaderCode& code, std::initializer_list<std::uint32_t> constants,
                 std::initializer_list<BufferView> buffers, const Push& push, std::uint64_t count) {
    if (!ok()) return;
    const auto& shader = pipeline(code, static_cast<std::uint32_t>(buffers.size()), sizeof(Push), constants);
    if (!device_.kernel_watch)
      return run([&](CommandRecorder& r) { r.dispatch_items(shader, buffers, push, count); });
    const auto start = std::chrono::steady_clock::now();
    run([&](CommandRecorder& r) { r.dispatch_items(shader, buffers, push, count); });
    device_.kernel_watch(code.name, count,
                         std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count());
  }
  /// Replaces each of the first `count` numbers by the sum of those before it and puts the total behind them
  /// (the buffer has count + 1 entries). Returns the total; fails when it reaches 2^32 − 1 (`what` says of
  /// what there are too many).
  std::uint32_t scan(const char* what, const VulkanBuffer& values, std::uint64_t count);

  /// Sets a whole buffer to a word.
  void fill(const VulkanBuffer& buffer, std::uint32_t word);
  std::uint32_t read(const VulkanBuffer& buffer, std::uint64_t entry);
  VulkanDevice& device() { return device_; }

 private:
  void finish();
  void scan_level(const VulkanBuffer& values, std::uint64_t count);

  VulkanDevice& device_;
  const Progress& progress_;
  std::optional<CommandRecorder> recorder_;
  std::optional<Error> error_;
  const char* what_ = "prepare";  ///< last told
  double done_ = 0;
  std::map<std::string, ComputePipeline> pipelines_;
  ComputePipeline no_pipeline_;
};

}  // namespace palpate

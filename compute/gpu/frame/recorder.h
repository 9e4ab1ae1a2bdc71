#pragma once
#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <initializer_list>
#include <span>
#include <vector>

#include "compute/vulkan/buffer.h"
#include "compute/vulkan/command_recorder.h"
#include "compute/vulkan/device.h"
#include "compute/vulkan/pipeline.h"
#include "model/result.h"
#include "shaders/shared/frame.h"

namespace palpate {

/// The buffers of a frame by the binding numbers of shaders/shared/frame.h and frame_response.h.
class FrameBuffers {
 public:
  FrameBuffers() = default;
  FrameBuffers(const FrameBuffers&) = delete;
  FrameBuffers& operator=(const FrameBuffers&) = delete;

  /// Names a buffer that somebody else owns and that outlives this.
  void name(std::int32_t binding, const VulkanBuffer& buffer) { named_[at(binding)] = &buffer; }
  /// Makes a buffer and owns it, unless it already has one there that is large enough. `what` is for
  /// sentences ("pairs"). Contents are undefined. After an error the buffer before, if any, is still there.
  Result<void> make(VulkanDevice& device, std::int32_t binding, const char* what, std::uint64_t bytes,
                    BufferKind kind = BufferKind::kDevice);
  /// Makes a table: a buffer that is all 0 between frames. The frame empties the entries that it filled;
  /// after an overflow clear_tables() does.
  Result<void> make_table(VulkanDevice& device, std::int32_t binding, const char* what, std::uint64_t bytes);
  /// Fills all tables with 0 and waits.
  Result<void> clear_tables(VulkanDevice& device) const;
  /// The buffer behind a binding; there must be one.
  const VulkanBuffer& operator[](std::int32_t binding) const;
  /// Bytes behind a binding, 0 if there is none.
  std::uint64_t bytes(std::int32_t binding) const;
  /// Bytes of the buffers that this owns.
  std::uint64_t owned_bytes() const;

  static constexpr std::int32_t kBindings = 128;  ///< binding numbers are below

 private:
  static std::size_t at(std::int32_t binding) { return static_cast<std::size_t>(binding); }
  std::array<VulkanBuffer, std::size_t{kBindings}> owned_;
  std::array<const VulkanBuffer*, std::size_t{kBindings}> named_{};
  std::vector<std::int32_t> tables_;
};

/// A shader of the frame. Its module names buffers by frame-wide numbers; the pipeline has them packed from
/// 0.
struct FrameShader {
  ComputePipeline pipeline;
  std::vector<std::int32_t> bindings;  ///< frame-wide number behind the pipeline's binding 0, 1, …
  std::vector<std::int32_t> measured;  ///< of these, whose length the shader asks
};

/// Builds the pipeline of a module that declares its buffers in set 0 by frame-wide numbers.
Result<FrameShader> make_frame_shader(VulkanDevice& device, const ShaderCode& code,
                                      std::uint32_t push_bytes = 0,
                                      std::span<const SpecConstant> constants = {});

/// As groups_for() and items_for() of shaders/lib/frame.glsl: so many workgroups, along x first; an
/// invocation an item.
inline gpu::DispatchArguments dispatch_of_groups(std::uint32_t groups) {
  return {std::min(groups, gpu::kMaxGroupsX), (groups + gpu::kMaxGroupsX - 1) / gpu::kMaxGroupsX, 1};
}
inline gpu::DispatchArguments dispatch_of_items(std::uint32_t items) {
  return dispatch_of_groups((items + gpu::kGroupSize - 1) / gpu::kGroupSize);
}

/// Records dispatches of a frame. No order between calls unless barrier() stands between them.
class FrameRecorder {
 public:
  /// All arguments outlive this.
  FrameRecorder(CommandRecorder& recorder, const FrameBuffers& buffers)
      : recorder_(recorder), buffers_(buffers) {}

  /// x workgroups, spread over two axes where one is too short.
  void run(const FrameShader& shader, std::uint32_t groups) { run(shader, groups, NoPush{}); }
  template <class Push>
  void run(const FrameShader& shader, std::uint32_t groups, const Push& push) {
    const std::uint32_t rows = (groups + gpu::kMaxGroupsX - 1) / gpu::kMaxGroupsX;
    recorder_.dispatch_raw(shader.pipeline, bound(shader), &push, push_bytes<Push>(),
                           std::min(groups, gpu::kMaxGroupsX), rows, 1);
  }
  /// As many workgroups as kDispatch… `which` says.
  void run_dispatch(const FrameShader& shader, std::uint32_t which) { run_dispatch(shader, which, NoPush{}); }
  template <class Push>
  void run_dispatch(const FrameShader& shader, std::uint32_t which, const Push& push) {
    indirect(shader, gpu::kBindDispatches, which * sizeof(gpu::DispatchArguments), &push, push_bytes<Push>());
  }
  /// As entry `which` of a stage's group counts says.
  void run_stage(const FrameShader& shader, std::int32_t groups, std::uint32_t which = 0) {
    indirect(shader, groups, which * sizeof(gpu::DispatchArguments), nullptr, 0);
  }
  /// As the three numbers at `offset` of a buffer say.
  void run_indirect(const FrameShader& shader, std::int32_t binding, std::uint64_t offset) {
    indirect(shader, binding, offset, nullptr, 0);
  }
  /// Fills a buffer with 0; copies all of `from`'s bytes from `offset` on that `to` has.
  void clear(std::int32_t binding) { recorder_.fill(buffers_[binding], 0); }
  void copy(std::int32_t from, std::uint64_t offset, std::int32_t to, std::uint64_t bytes) {
    recorder_.copy(buffers_[from], offset, buffers_[to], 0, bytes);
  }
  void barrier() { recorder_.barrier(); }
  /// See CommandRecorder::stage.
  void stage(const char* name) { recorder_.stage(name); }
  /// Every pipeline that was recorded, once.
  const std::vector<const ComputePipeline*>& used() const { return used_; }

 private:
  template <class Push>
  static constexpr std::uint32_t push_bytes() {
    return std::is_same_v<Push, NoPush> ? 0 : static_cast<std::uint32_t>(sizeof(Push));
  }
  std::span<const BufferView> bound(const FrameShader& shader);
  void indirect(const FrameShader& shader, std::int32_t binding, std::uint64_t offset, const void* push,
                std::uint32_t push_bytes);

  CommandRecorder& recorder_;
  const FrameBuffers& buffers_;
  std::vector<BufferView> views_;
  std::vector<const ComputePipeline*> used_;
};

}  // namespace palpate

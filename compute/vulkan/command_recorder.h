#pragma once
#include <vulkan/vulkan.h>

#include <cassert>
#include <cstdint>
#include <initializer_list>
#include <optional>
#include <span>
#include <vector>

#include "compute/vulkan/buffer.h"
#include "compute/vulkan/device.h"
#include "compute/vulkan/pipeline.h"
#include "model/result.h"
#include "shaders/shared/base.h"

namespace palpate {

/// A whole buffer, or a part of one, bound to a shader.
struct BufferView {
  // NOLINTNEXTLINE(google-explicit-constructor)
  BufferView(const VulkanBuffer& whole) : buffer(whole.handle()), texels(whole.texels()) {}
  BufferView(const VulkanBuffer& part, std::uint64_t from, std::uint64_t length)
      : buffer(part.handle()), offset(from), bytes(length) {}
  VkBuffer buffer;
  VkDeviceSize offset = 0;
  VkDeviceSize bytes = VK_WHOLE_SIZE;
  VkBufferView texels = VK_NULL_HANDLE;  ///< of the whole
};

/// Push constants of a shader that has none.
struct NoPush {};

/// A command buffer with its fence and its timestamps. Record once (begin … end), submit as often as needed.
/// Nothing is ordered unless barrier() is called between. One thread; submit() and wait() do not allocate.
class CommandRecorder {
 public:
  /// `stages`: how many times stage() may be called; 0 for no timestamps.
  static Result<CommandRecorder> create(VulkanDevice& device, std::uint32_t stages = 0);
  ~CommandRecorder();
  CommandRecorder(CommandRecorder&& other) noexcept;
  CommandRecorder& operator=(CommandRecorder&& other) noexcept;
  CommandRecorder(const CommandRecorder&) = delete;
  CommandRecorder& operator=(const CommandRecorder&) = delete;

  /// Starts recording anew; host writes before a later submit are visible to it.
  void begin();

  /// Runs x·y·z workgroups. `buffers` are bindings 0, 1, …; `push` must have the pipeline's push size.
  template <class Push>
  void dispatch(const ComputePipeline& pipeline, std::initializer_list<BufferView> buffers, const Push& push,
                std::uint32_t x, std::uint32_t y = 1, std::uint32_t z = 1) {
    dispatch_raw(pipeline, std::span(buffers.begin(), buffers.size()), &push, push_size<Push>(), x, y, z);
  }
  /// One invocation for each of `count` items, in workgroups of gpu::kItemGroup, over two axes where one is
  /// too short (shader: `item_index()` of lib/item.glsl). Nothing when count is 0.
  template <class Push>
  void dispatch_items(const ComputePipeline& pipeline, std::initializer_list<BufferView> buffers,
                      const Push& push, std::uint64_t count) {
    const std::uint64_t groups = (count + gpu::kItemGroup - 1) / gpu::kItemGroup;
    if (groups == 0) return;
    const std::uint64_t rows = (groups + max_groups_ - 1) / max_groups_;
    const std::uint64_t row = (groups + rows - 1) / rows;
    dispatch_raw(pipeline, std::span(buffers.begin(), buffers.size()), &push, push_size<Push>(),
                 static_cast<std::uint32_t>(row), static_cast<std::uint32_t>(rows), 1);
  }
  /// Runs as many workgroups as three uint32 at `arguments` + `offset` say.
  template <class Push>
  void dispatch_indirect(const ComputePipeline& pipeline, std::initializer_list<BufferView> buffers,
                         const Push& push, const VulkanBuffer& arguments, std::uint64_t offset) {
    dispatch_indirect_raw(pipeline, std::span(buffers.begin(), buffers.size()), &push, push_size<Push>(),
                          arguments, offset);
  }
  void dispatch_indirect_raw(const ComputePipeline& pipeline, std::span<const BufferView> buffers,
                             const void* push, std::uint32_t push_bytes, const VulkanBuffer& arguments,
                             std::uint64_t offset) {
    if (bind(pipeline, buffers, push, push_bytes))
      vkCmdDispatchIndirect(commands_, arguments.handle(), offset);
  }
  void dispatch_raw(const ComputePipeline& pipeline, std::span<const BufferView> buffers, const void* push,
                    std::uint32_t push_bytes, std::uint32_t x, std::uint32_t y, std::uint32_t z);

  /// Everything recorded so far is complete and visible to all that follows: shaders, indirect arguments,
  /// copies. end() does the same for the host.
  void barrier() { barrier(0, 0); }
  /// Sets every 32-bit word of [offset, offset + bytes) to `word`; bytes a multiple of 4.
  void fill(const VulkanBuffer& buffer, std::uint32_t word) {
    fill(buffer.handle(), word, 0, buffer.bytes());
  }
  void fill(VkBuffer buffer, std::uint32_t word, std::uint64_t offset, std::uint64_t bytes);
  void copy(const VulkanBuffer& from, std::uint64_t from_offset, const VulkanBuffer& to,
            std::uint64_t to_offset, std::uint64_t bytes) {
    copy(from.handle(), from_offset, to.handle(), to_offset, bytes);
  }
  void copy(VkBuffer from, std::uint64_t from_offset, VkBuffer to, std::uint64_t to_offset,
            std::uint64_t bytes);
  /// Begins the stage `name` (a literal): what follows counts as its time until the next stage or the end.
  void stage(const char* name);
  /// Ends recording; called by submit_and_wait() if need be.
  Result<void> end();

  /// Recorded since begin(): dispatches of any size, and barriers.
  std::uint32_t dispatches() const { return dispatches_; }
  std::uint32_t barriers() const { return barriers_; }

  Result<void> submit();
  /// Waits for the last submit; a message of the validation layer since then is an error, too.
  Result<void> wait(std::uint64_t timeout_ns = 60'000'000'000);
  /// Both, with all the time that a large scene's preparation may take on a busy machine without a GPU: ten
  /// minutes.
  Result<void> submit_and_wait();

  struct StageTime {
    const char* name;
    double us;
  };
  /// Device time by stage of the last finished submit, in the order of recording. Replaces the contents of
  /// `out`.
  Result<void> times(std::vector<StageTime>& out) const;

 private:
  CommandRecorder() = default;
  void barrier(VkPipelineStageFlags2 more_stages, VkAccessFlags2 more_access);
  template <class Push>
  static constexpr std::uint32_t push_size() {
    return std::is_same_v<Push, NoPush> ? 0 : static_cast<std::uint32_t>(sizeof(Push));
  }
  /// Until the last submit is finished, or some time has gone by.
  void spin() const;
  /// False: there is no such pipeline; end() tells why.
  bool bind(const ComputePipeline& pipeline, std::span<const BufferView> buffers, const void* push,
            std::uint32_t push_bytes);

  VulkanDevice* device_ = nullptr;
  VkCommandPool pool_ = VK_NULL_HANDLE;
  VkCommandBuffer commands_ = VK_NULL_HANDLE;
  VkFence fence_ = VK_NULL_HANDLE;
  VkQueryPool queries_ = VK_NULL_HANDLE;
  std::uint32_t stage_limit_ = 0;
  std::uint32_t max_groups_ = 1;
  std::vector<const char*> stages_;
  std::optional<Error> refused_;  ///< a pipeline that could not be made, since begin()
  std::uint32_t dispatches_ = 0, barriers_ = 0;
  bool recording_ = false;
  bool pending_ = false;  ///< submitted, and not known to be finished
};

}  // namespace palpate

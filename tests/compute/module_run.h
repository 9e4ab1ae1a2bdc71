#pragma once
#include <algorithm>
#include <array>
#include <cstdint>
#include <cstring>
#include <random>
#include <string>
#include <vector>

#include "compute/vulkan/buffer.h"
#include "compute/vulkan/command_recorder.h"
#include "compute/vulkan/device.h"
#include "compute/vulkan/pipeline.h"

namespace palpate {

using Words = std::vector<std::uint32_t>;

/// Anything of whole words as words.
template <class T>
Words words_of(const T* values, std::size_t count) {
  static_assert(sizeof(T) % 4 == 0);
  Words words(count * sizeof(T) / 4);
  if (count > 0) std::memcpy(words.data(), values, words.size() * 4);
  return words;
}
template <class T>
Words words_of(const std::vector<T>& values) {
  return words_of(values.data(), values.size());
}
template <class T>
Words push_of(const T& push) {
  return words_of(&push, 1);
}
template <class T>
std::vector<T> values_of(const Words& words) {
  std::vector<T> values(words.size() * 4 / sizeof(T));
  if (!values.empty()) std::memcpy(values.data(), words.data(), values.size() * sizeof(T));
  return values;
}

/// 32 random bits at a time, the same on every machine.
class Numbers {
 public:
  using result_type = std::uint32_t;
  explicit Numbers(result_type seed) : engine_(seed) {}
  static constexpr result_type min() { return 0; }
  static constexpr result_type max() { return ~result_type{0}; }
  result_type operator()() { return static_cast<result_type>(engine_()); }

 private:
  std::mt19937 engine_;
};

/// One run of one module of shaders/ on made-up buffers: what it is given, all of it.
struct ModuleRun {
  std::string module;          ///< "row_init"
  std::vector<Words> buffers;  ///< contents before, bindings 0, 1, …
  Words push;
  std::uint32_t items = 0;  ///< at least so many invocations are run, in whole workgroups
  Words constants = {};     ///< ids 0, 1, …
  std::uint32_t rows = 1;   ///< of workgroups: over two axes, as where one is too short
  int forest =
      -1;  ///< binding of parents: which node is hung under which is nobody's business, each one's root is
  int pairs = -1;  ///< binding of pairs in no order
};

/// Buffers with what is free to differ taken out.
inline std::vector<Words> settled(const ModuleRun& run, std::vector<Words> after) {
  if (run.forest >= 0) {
    Words& parent = after[static_cast<std::size_t>(run.forest)];
    Words roots = parent;
    for (std::uint32_t& root : roots)
      for (std::size_t k = 0; k < parent.size() && root < parent.size() && parent[root] != root; ++k)
        root = parent[root];
    parent = roots;
  }
  if (run.pairs >= 0) {
    Words& pairs = after[static_cast<std::size_t>(run.pairs)];
    auto sorted = values_of<std::array<std::uint32_t, 2>>(pairs);
    std::sort(sorted.begin(), sorted.end());
    pairs = words_of(sorted);
  }
  return after;
}

/// The contents of all buffers after the run, settled.
inline Result<std::vector<Words>> run_module(VulkanDevice& device, const ShaderCode& code,
                                             const ModuleRun& run) {
  std::vector<SpecConstant> constants;
  for (const std::uint32_t value : run.constants)
    constants.push_back({static_cast<std::uint32_t>(constants.size()), value});
  const auto pipeline = ComputePipeline::create(device, code, static_cast<std::uint32_t>(run.buffers.size()),
                                                static_cast<std::uint32_t>(run.push.size() * 4), constants);
  if (!pipeline) return pipeline.error();
  if (auto made = pipeline->wait(); !made) return made.error();
  std::vector<VulkanBuffer> buffers;
  std::vector<BufferView> views;
  for (const Words& words : run.buffers) {
    auto buffer = VulkanBuffer::create(device, "a module's buffer", words.size() * 4, BufferKind::kDevice);
    if (!buffer) return buffer.error();
    if (auto r = upload(device, *buffer, words.data(), words.size() * 4); !r) return r.error();
    buffers.push_back(std::move(*buffer));
    views.emplace_back(buffers.back());
  }
  auto recorder = CommandRecorder::create(device);
  if (!recorder) return recorder.error();
  recorder->begin();
  const std::uint32_t groups = (run.items + gpu::kItemGroup - 1) / gpu::kItemGroup;
  recorder->dispatch_raw(*pipeline, views, run.push.data(), static_cast<std::uint32_t>(run.push.size() * 4),
                         (groups + run.rows - 1) / run.rows, run.rows, 1);
  if (auto r = recorder->submit_and_wait(); !r) return r.error();
  std::vector<Words> after = run.buffers;
  for (std::size_t i = 0; i < after.size(); ++i)
    if (auto r = download(device, buffers[i], 0, after[i].data(), after[i].size() * 4); !r) return r.error();
  if (auto r = device.check_guards(); !r) return r.error();
  return settled(run, std::move(after));
}

}  // namespace palpate

#include "compute/gpu/frame/recorder.h"

#include <algorithm>
#include <cassert>
#include <map>
#include <string>

namespace palpate {
namespace {

// Words of SPIR-V that matter here (specification 2.3, 3.20, 3.32.3): a five-word header, then instructions
// that begin with (length << 16 | opcode). OpDecorate target decoration literal; OpArrayLength type result
// variable member; OpVariable type result class.
constexpr std::size_t kHeaderWords = 5;
constexpr std::uint32_t kOpArrayLength = 68;
constexpr std::uint32_t kOpVariable = 59;
constexpr std::uint32_t kOpDecorate = 71;
constexpr std::uint32_t kDecorationBinding = 33;
constexpr std::uint32_t kUniformConstant = 0;  // a storage class: texel buffers alone have it here

/// Calls `f` with a reference to each binding number of a module.
template <class F>
void for_each_binding(std::span<std::uint32_t> words, F f) {
  for (std::size_t i = kHeaderWords; i < words.size();) {
    const std::uint32_t length = words[i] >> 16;
    if ((words[i] & 0xFFFFu) == kOpDecorate && words[i + 2] == kDecorationBinding) f(words[i + 3]);
    if (length == 0) return;
    i += length;
  }
}

/// What a module says of its bindings.
struct ModuleBindings {
  std::vector<std::uint32_t> measured;  ///< whose number of entries it asks
  std::vector<std::uint32_t> texels;    ///< that it sees as texels
};

ModuleBindings bindings_of(std::span<const std::uint32_t> words) {
  std::map<std::uint32_t, std::uint32_t> binding_of;  // by variable; decorations stand before all else
  ModuleBindings out;
  for (std::size_t i = kHeaderWords; i < words.size() && words[i] >> 16 != 0; i += words[i] >> 16) {
    const std::uint32_t opcode = words[i] & 0xFFFFu;
    if (opcode == kOpDecorate && words[i + 2] == kDecorationBinding) binding_of[words[i + 1]] = words[i + 3];
    if (opcode == kOpArrayLength) out.measured.push_back(binding_of.at(words[i + 3]));
    if (opcode == kOpVariable && words[i + 3] == kUniformConstant)
      out.texels.push_back(binding_of.at(words[i + 2]));
  }
  return out;
}

}  // namespace

Result<void> FrameBuffers::make(VulkanDevice& device, std::int32_t binding, const char* what,
                                std::uint64_t bytes, BufferKind kind) {
  if (owned_[at(binding)] && owned_[at(binding)].bytes() >= bytes) return {};
  auto buffer = VulkanBuffer::create(device, what, bytes, kind);
  if (!buffer) return buffer.error();
  owned_[at(binding)] = std::move(*buffer);
  named_[at(binding)] = &owned_[at(binding)];
  return {};
}

Result<void> FrameBuffers::make_table(VulkanDevice& device, std::int32_t binding, const char* what,
                                      std::uint64_t bytes) {
  if (auto r = make(device, binding, what, bytes); !r) return r;
  if (std::find(tables_.begin(), tables_.end(), binding) == tables_.end()) tables_.push_back(binding);
  return {};
}

Result<void> FrameBuffers::clear_tables(VulkanDevice& device) const {
  auto recorder = CommandRecorder::create(device);
  if (!recorder) return recorder.error();
  recorder->begin();
  for (const std::int32_t binding : tables_) recorder->fill((*this)[binding], 0);
  return recorder->submit_and_wait();
}

const VulkanBuffer& FrameBuffers::operator[](std::int32_t binding) const {
  assert(named_[at(binding)] != nullptr && "a shader uses a buffer that nobody made");
  return *named_[at(binding)];
}

std::uint64_t FrameBuffers::bytes(std::int32_t binding) const {
  if (owned_[at(binding)]) return owned_[at(binding)].bytes();
  const VulkanBuffer* named = named_[at(binding)];
  return named && *named ? named->bytes() : 0;
}

std::uint64_t FrameBuffers::owned_bytes() const {
  std::uint64_t sum = 0;
  for (const VulkanBuffer& buffer : owned_) sum += buffer ? buffer.bytes() : 0;
  return sum;
}

Result<FrameShader> make_frame_shader(VulkanDevice& device, const ShaderCode& code, std::uint32_t push_bytes,
                                      std::span<const SpecConstant> constants) {
  FrameShader out;
  const bool texels = device.texels() && code.texel_words != nullptr;
  const std::span<const std::uint32_t> module =
      texels ? std::span(code.texel_words, code.texel_bytes / 4) : std::span(code.words, code.bytes / 4);
  std::vector<std::uint32_t> words(module.begin(), module.end());
  for_each_binding(words, [&](std::uint32_t& b) { out.bindings.push_back(static_cast<std::int32_t>(b)); });
  const ModuleBindings found = bindings_of(words);
  out.measured.assign(found.measured.begin(), found.measured.end());
  std::sort(out.bindings.begin(), out.bindings.end());
  out.bindings.erase(std::unique(out.bindings.begin(), out.bindings.end()), out.bindings.end());
  for_each_binding(words, [&](std::uint32_t& b) {
    const auto at = std::lower_bound(out.bindings.begin(), out.bindings.end(), static_cast<std::int32_t>(b));
    b = static_cast<std::uint32_t>(at - out.bindings.begin());
  });
  BindingKinds kinds;
  for (std::size_t i = 0; i < out.bindings.size(); ++i)
    if (out.bindings[i] == gpu::kBindScene || out.bindings[i] == gpu::kBindFrameInput)
      kinds.uniform |= 1u << i;
  for (const std::uint32_t texels_of : found.texels)
    kinds.texels |= 1u << (std::lower_bound(out.bindings.begin(), out.bindings.end(),
                                            static_cast<std::int32_t>(texels_of)) -
                           out.bindings.begin());
  auto pipeline =
      ComputePipeline::create(device, {code.name, words.data(), 4 * words.size()},
                              static_cast<std::uint32_t>(out.bindings.size()), push_bytes, constants, kinds);
  if (!pipeline) return pipeline.error();
  out.pipeline = std::move(*pipeline);
  return out;
}

std::span<const BufferView> FrameRecorder::bound(const FrameShader& shader) {
  if (std::find(used_.begin(), used_.end(), &shader.pipeline) == used_.end())
    used_.push_back(&shader.pipeline);
  views_.clear();
  for (const std::int32_t binding : shader.bindings) {
    const VulkanBuffer& buffer = buffers_[binding];
    const bool measured =
        std::find(shader.measured.begin(), shader.measured.end(), binding) != shader.measured.end();
    views_.push_back(measured ? BufferView(buffer, 0, buffer.bytes())
                              : BufferView(buffer));  // a guard is no entry
  }
  return views_;
}

void FrameRecorder::indirect(const FrameShader& shader, std::int32_t binding, std::uint64_t offset,
                             const void* push, std::uint32_t push_bytes) {
  recorder_.dispatch_indirect_raw(shader.pipeline, bound(shader), push, push_bytes, buffers_[binding],
                                  offset);
}

}  // namespace palpate

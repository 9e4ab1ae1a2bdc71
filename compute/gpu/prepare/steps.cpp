#include "compute/gpu/prepare/steps.h"

#include <utility>

#include "shaders/code.h"
#include "shaders/shared/prepare.h"

namespace palpate {

PrepareSteps::PrepareSteps(VulkanDevice& device, const Progress& progress)
    : device_(device), progress_(progress) {
  auto recorder = CommandRecorder::create(device);
  if (recorder)
    recorder_.emplace(std::move(*recorder));
  else
    fail(recorder.error());
}

void PrepareSteps::fail(Error error) {
  if (ok()) error_ = std::move(error);
}

void PrepareSteps::progress(const char* what, double done) {
  what_ = what;
  done_ = done;
  if (ok() && progress_ && !progress_(what, done))
    fail(Error{ErrorCode::kInternal, "preparation was cancelled"});
}

VulkanBuffer PrepareSteps::buffer(const char* what, std::uint64_t entries, std::uint64_t entry_bytes,
                                  BufferKind kind) {
  if (!ok()) return {};
  auto made = VulkanBuffer::create(device_, what, entries * entry_bytes, kind);
  if (!made) {
    fail(made.error());
    return {};
  }
  return std::move(*made);
}

VulkanBuffer PrepareSteps::filled(const char* what, const void* data, std::uint64_t entries,
                                  std::uint64_t entry_bytes, BufferKind kind) {
  VulkanBuffer out = buffer(what, entries, entry_bytes, kind);
  if (ok())
    if (auto r = upload(device_, out, data, entries * entry_bytes); !r) fail(r.error());
  return out;
}

const ComputePipeline& PrepareSteps::pipeline(const ShaderCode& code, std::uint32_t buffers,
                                              std::uint32_t push_bytes,
                                              std::initializer_list<std::uint32_t> constants) {
  if (!ok()) return no_pipeline_;
  std::string key = code.name;
  std::vector<SpecConstant> list;
  for (const std::uint32_t value : constants) {
    list.push_back({static_cast<std::uint32_t>(list.size()), value});
    key += " " + std::to_string(value);
  }
  const auto found = pipelines_.find(key);
  if (found != pipelines_.end()) return found->second;
  auto made = ComputePipeline::create(device_, code, buffers, push_bytes, list);
  if (!made) {
    fail(made.error());
    return no_pipeline_;
  }
  return pipelines_.emplace(key, std::move(*made)).first->second;
}

void PrepareSteps::finish() {
  if (auto r = recorder_->submit_and_wait(); !r) fail(r.error());
  progress(what_, done_);  // whoever wants to end it waits for one submission at most
}

void PrepareSteps::fill(const VulkanBuffer& buffer, std::uint32_t word) {
  run([&](CommandRecorder& r) { r.fill(buffer, word); });
}

std::uint32_t PrepareSteps::read(const VulkanBuffer& buffer, std::uint64_t entry) {
  std::uint32_t value = 0;
  if (!ok()) return 0;
  if (auto r = download(device_, buffer, entry * 4, &value, 4); !r) fail(r.error());
  return ok() ? value : 0;
}

void PrepareSteps::scan_level(const VulkanBuffer& values, std::uint64_t count) {
  const std::uint64_t chunks = (count + gpu::kScanChunk - 1) / gpu::kScanChunk;
  struct Push {
    std::uint32_t count, has_bases;
  } const push{static_cast<std::uint32_t>(count), chunks > 1 ? 1u : 0u};
  VulkanBuffer sums = buffer("prefix sums", chunks);
  if (chunks > 1) {
    run_items(spirv::scan_chunks, {}, {values, sums}, push.count, chunks);
    scan_level(sums, chunks);
  }
  run_items(spirv::scan_apply, {}, {values, sums}, push, chunks);
}

std::uint32_t PrepareSteps::scan(const char* what, const VulkanBuffer& values, std::uint64_t count) {
  // The entry behind the last counts as 0, and so ends as the total.
  run([&](CommandRecorder& r) { r.fill(values.handle(), 0, count * 4, 4); });
  scan_level(values, count + 1);
  const std::uint32_t total = read(values, count);
  if (total == 0xFFFFFFFFu)
    fail(bad_value(std::string("more than 4294967294 ") + what + "; a larger voxel would do with fewer"));
  return ok() ? total : 0;
}

}  // namespace palpate

#include "tests/mutation/shader_probes.h"

#include <cstring>
#include <stdexcept>

#include "compute/vulkan/buffer.h"
#include "compute/vulkan/command_recorder.h"
#include "compute/vulkan/pipeline.h"
#include "tests/compute/probe_cases.h"

namespace palpate::mutation {

template <class Answer, class Case>
void ShaderProbes::add(const char* name, const std::vector<Case>& cases) {
  Probe probe;
  probe.cases.resize(cases.size() * sizeof(Case));
  std::memcpy(probe.cases.data(), cases.data(), probe.cases.size());
  probe.count = static_cast<std::uint32_t>(cases.size());
  probe.answer_bytes = cases.size() * sizeof(Answer);
  probes_.emplace(std::string("tests/compute/shaders/") + name + ".comp", std::move(probe));
}

ShaderProbes::ShaderProbes(VulkanDevice& device) : device_(device) {
  add<gpu::WideAnswer>("probe_wide_integer", probe_cases::wide());
  add<std::int32_t>("probe_triangle_pair", probe_cases::pairs());
  add<std::int32_t>("probe_triangle_voxel", probe_cases::boxes());
  add<gpu::RayAnswer>("probe_ray", probe_cases::rays());
  add<gpu::SegmentAnswer>("probe_segment", probe_cases::segments());
  add<gpu::SampleAnswer>("probe_sample", probe_cases::samples());
  add<gpu::DistanceAnswer>("probe_distance", probe_cases::distances());
  add<gpu::CellAnswer>("probe_cells", probe_cases::cells());
  add<Int3>("probe_direction", probe_cases::directions());
  add<gpu::PoseAnswer>("probe_pose", probe_cases::poses());
  add<gpu::PartitionAnswer>("probe_partition", probe_cases::partitions());
  add<gpu::GroupsAnswer>("probe_groups", probe_cases::groups());
}

std::string ShaderProbes::run(const Probe& probe, const std::string& code, Bytes& answers) {
  std::vector<std::uint32_t> words(code.size() / 4);
  std::memcpy(words.data(), code.data(), code.size());
  const auto pipeline = ComputePipeline::create(device_, {"probe", words.data(), code.size()}, 2, 4);
  // Nobody asks the same mutant again.
  std::erase_if(device_.pipelines, [&](const auto& made) {
    const auto& key = made.first;
    return key.size() >= words.size() &&
           std::memcmp(key.data() + (key.size() - words.size()), words.data(), code.size()) == 0;
  });
  if (!pipeline) return pipeline.error().sentence;
  auto from = VulkanBuffer::create(device_, "probe input", probe.cases.size(), BufferKind::kUpload);
  if (!from) return from.error().sentence;
  auto to = VulkanBuffer::create(device_, "probe output", probe.answer_bytes, BufferKind::kReadback);
  if (!to) return to.error().sentence;
  if (auto r = upload(device_, *from, probe.cases.data(), probe.cases.size()); !r) return r.error().sentence;
  auto recorder = CommandRecorder::create(device_);
  if (!recorder) return recorder.error().sentence;
  recorder->begin();
  // In rows, as where there are more workgroups than a row of a dispatch may have.
  constexpr std::uint32_t kRow = 5;
  const std::uint32_t groups = (probe.count + gpu::kItemGroup - 1) / gpu::kItemGroup;
  recorder->dispatch(*pipeline, {*from, *to}, probe.count, kRow, (groups + kRow - 1) / kRow, 1);
  if (auto r = recorder->submit_and_wait(); !r) return r.error().sentence;
  answers.resize(probe.answer_bytes);
  if (auto r = download(device_, *to, 0, answers.data(), answers.size()); !r) return r.error().sentence;
  if (auto r = device_.check_guards(); !r) return r.error().sentence;
  return {};
}

std::string ShaderProbes::difference(const std::string& name, const std::string& original,
                                     const std::string& mutant) {
  Probe& probe = probes_.at(name);
  if (probe.known.empty())
    if (const std::string failure = run(probe, original, probe.known); !failure.empty())
      throw std::runtime_error(name + ": " + failure);
  Bytes answers;
  if (std::string failure = run(probe, mutant, answers); !failure.empty()) return failure;
  const std::size_t each = probe.answer_bytes / probe.count;
  for (std::size_t i = 0; i < probe.count; ++i)
    if (std::memcmp(answers.data() + i * each, probe.known.data() + i * each, each) != 0)
      return "case " + std::to_string(i);
  return {};
}

}  // namespace palpate::mutation

#include "tests/mutation/mutable_device.h"

#include <algorithm>
#include <cstring>
#include <stdexcept>

#include "compute/gpu/frame/capacity.h"

namespace palpate::mutation {
namespace {

using Words = std::vector<std::uint32_t>;  // of a module

Words words_of(const std::string& bytes) {
  Words words(bytes.size() / 4);
  std::memcpy(words.data(), bytes.data(), bytes.size());
  return words;
}

/// Calls visit(binding) for the number in every `OpDecorate … Binding`; visit may change it.
template <class Visit>
void for_each_binding(Words& words, const Visit& visit) {
  constexpr std::uint32_t kOpDecorate = 71, kBinding = 33;
  constexpr std::size_t kHeader = 5;
  for (std::size_t at = kHeader; at < words.size() && words[at] >> 16 != 0; at += words[at] >> 16)
    if ((words[at] & 0xFFFFu) == kOpDecorate && words[at + 2] == kBinding) visit(words[at + 3]);
}

Words bindings(Words words) {
  Words found;
  for_each_binding(words, [&](std::uint32_t& binding) { found.push_back(binding); });
  return found;
}

Words without_bindings(Words words) {
  for_each_binding(words, [](std::uint32_t& binding) { binding = 0; });
  return words;
}

/// A frame numbers a module's buffers anew; its mutant's are numbered in the same way.
Words bound_alike(const Words& original, Words mutant, const Words& numbered) {
  const Words before = bindings(original), after = bindings(numbered);
  for_each_binding(mutant, [&](std::uint32_t& binding) {
    const auto found = std::find(before.begin(), before.end(), binding);
    if (found != before.end()) binding = after[static_cast<std::size_t>(found - before.begin())];
  });
  return mutant;
}

}  // namespace

MutableDevice::MutableDevice(bool as_gpu) {
  GpuOptions options;
  options.own_memory = as_gpu;
  options.guard_buffers = true;
  auto device = VulkanDevice::create(options);
  if (!device) throw std::runtime_error(device.error().sentence);
  device_ = std::move(*device);
}

/// Lists are as long as any small case needs, not as a frame makes them at first: half of a case's time went
/// into filling their guards.
Result<std::unique_ptr<Frame>> MutableDevice::make_frame(const SceneGeometry& geometry) {
  constexpr std::uint32_t kRoom = 1u << 14;
  std::map<std::string, std::uint32_t> room = first_capacity_;
  for (std::uint32_t list = 0; list_name(list) != nullptr; ++list) room.emplace(list_name(list), kRoom);
  return Frame::create(*device_, geometry, scene(), room);
}

void MutableDevice::list_samples(bool listed) {
  VulkanBuffer &there = kept_of_->scene.sample_points, &aside = kept_of_->points;
  if (listed ? !there : static_cast<bool>(there)) std::swap(there, aside);
}

Result<void> MutableDevice::prepare(const SceneGeometry& geometry, const Plan& plan,
                                    const Progress& progress) {
  frame_.reset();
  fresh_.reset();
  const auto found = kept_.find(&geometry);
  const bool by_mutant = prepares_ && !aside_;
  if (by_mutant || found == kept_.end()) {
    auto scene = prepare_scene(*device_, geometry, plan, progress);
    if (!scene) return scene.error();
    if (by_mutant) {
      fresh_.emplace(std::move(*scene));
    } else {
      Prepared made{std::move(*scene), {}, {}, {}};
      for (const bool tool : {false, true}) {
        const PartitionBuffers& of = tool ? made.scene.tool.partition : made.scene.mockup.partition;
        if (!of.brick_slot) continue;  // `paper` has none of the tool
        auto partition = read_partition(*device_, of);
        if (!partition) return partition.error();
        (tool ? made.tool : made.mockup) = dense(*partition);
      }
      kept_of_ = &kept_.emplace(&geometry, std::move(made)).first->second;
      for (const bool without : {true, false}) {  // so that the pipelines of all ways are there to be swapped
        list_samples(!without);
        if (auto other = make_frame(geometry); !other) return other.error();
      }
    }
  } else {
    kept_of_ = &found->second;
  }
  if (!fresh_) list_samples(!without_samples_);
  auto frame = make_frame(geometry);
  if (!frame) return frame.error();
  frame_ = std::move(*frame);
  return device_->check_guards();
}

Result<void> MutableDevice::query(const LatticePose& pose, const Ignored* ignored, Contacts& out) {
  if (auto r = frame_->query(pose, ignored, out); !r) return r;
  return device_->check_guards();
}

Result<VoxelPartition> MutableDevice::partition(bool tool) const {
  if (fresh_) {
    const auto read = read_partition(*device_, tool ? fresh_->tool.partition : fresh_->mockup.partition);
    if (!read) return read.error();
    return dense(*read);
  }
  return tool ? kept_of_->tool : kept_of_->mockup;
}

Result<void> MutableDevice::swap(const std::string& original, const std::string& mutant, bool prepares) {
  prepares_ = prepares_ || prepares;
  mutants_.emplace_back(words_of(original), words_of(mutant));
  return swap_all(mutants_.back().first, mutants_.back().second);
}

Result<void> MutableDevice::swap_all(const Words& before, const Words& after) {
  const Words bare = without_bindings(before);
  std::vector<Key> keys;
  for (const auto& [key, made] : device_->pipelines)
    if (std::none_of(swapped_.begin(), swapped_.end(), [&](const auto& s) { return s.first == key; }))
      keys.push_back(key);
  for (const Key& key : keys) {  // buffers, bytes of push constants, which are uniform, which are texels,
                                 // number of constants, (id, value) …, words of the module
    std::vector<SpecConstant> constants;
    for (std::size_t i = 0; i < key[4]; ++i) constants.push_back({key[5 + 2 * i], key[6 + 2 * i]});
    const Words code(key.begin() + 5 + 2 * static_cast<std::ptrdiff_t>(key[4]), key.end());
    if (code.size() != before.size() || without_bindings(code) != bare) continue;
    const Words changed = bound_alike(before, after, code);
    const auto made = ComputePipeline::create(*device_, {"mutant", changed.data(), changed.size() * 4},
                                              key[0], key[1], constants, {key[2], key[3]});
    if (!made) return made.error();
    if (auto there = made->wait(); !there) return there.error();
    Key mutants_key(key.begin(), key.end() - static_cast<std::ptrdiff_t>(code.size()));
    mutants_key.insert(mutants_key.end(), changed.begin(), changed.end());
    swapped_.emplace_back(key, device_->pipelines[key]);
    device_->pipelines[key] = device_->pipelines[mutants_key];
    device_->pipelines.erase(mutants_key);
  }
  return {};
}

void MutableDevice::restore() {
  // What a mutant wrote round a frame's buffers goes with them; round a prepared scene's it stays, and is
  // told again.
  if (!mutants_.empty() && !device_->guard_error.empty()) {
    frame_.reset();
    device_->guard_error.clear();
  }
  for (auto& [key, made] : swapped_) device_->pipelines[key] = std::move(made);
  swapped_.clear();
  mutants_.clear();
  prepares_ = false;
}

void MutableDevice::set_aside() {
  for (auto& [key, other] : swapped_) device_->pipelines[key].swap(other);
  aside_ = true;
}

Result<void> MutableDevice::put_back() {
  for (auto& [key, other] : swapped_) device_->pipelines[key].swap(other);
  aside_ = false;
  for (const auto& [before, after] : mutants_)
    if (auto r = swap_all(before, after); !r) return r;
  return {};
}

}  // namespace palpate::mutation

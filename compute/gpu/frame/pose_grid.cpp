#include "compute/gpu/frame/pose_grid.h"

#include <algorithm>
#include <array>
#include <chrono>
#include <optional>
#include <utility>
#include <vector>

#include "compute/gpu/frame/capacity.h"
#include "compute/gpu/frame/decode.h"
#include "compute/gpu/frame/detection.h"
#include "compute/gpu/frame/field.h"
#include "compute/gpu/frame/plan.h"
#include "compute/gpu/frame/recorder.h"
#include "compute/gpu/frame/scene_buffers.h"
#include "compute/vulkan/command_recorder.h"
#include "model/contact/contact_areas.h"
#include "shaders/shared/frame_batch.h"

namespace palpate {
namespace {

using namespace gpu;  // names of shaders/shared/

// Poses of a submission (chosen): so that a GPU's lanes are full, and that lavapipe's lists stay small, where
// more of them gain nothing.
constexpr std::uint32_t kPosesOfGpu = 2048, kPosesOfProcessor = 256;
// A list that more than this many items would have grown to has fewer poses instead (chosen).
constexpr std::uint32_t kMostItemsOfList = 1u << 22;
constexpr std::uint32_t kStages = 16;  // most calls of stage()

using Clock = std::chrono::steady_clock;

double us_since(Clock::time_point from) {
  return std::chrono::duration<double, std::micro>(Clock::now() - from).count();
}

class RecordedGrid final : public PoseGrid {
 public:
  RecordedGrid(VulkanDevice& device, const SceneGeometry& geometry, const PreparedScene& scene,
               const Plan& plan)
      : device_(device),
        geometry_(geometry),
        scene_(scene),
        plan_(frame_plan(plan, scene.mockup.partition.has_internal)),
        flags_(flags_of_frames(scene.constants)) {}

  Result<void> make(const std::map<std::string, std::uint32_t>& first_capacity);
  std::size_t most() const override { return most_; }
  Result<void> ask(std::span<const GridPose> poses) override;
  Result<void> touch(std::span<const LatticePose> poses, std::span<std::uint8_t> bits) override;
  DeviceWork work() const override { return work_; }
  std::uint64_t memory_bytes() const override { return buffers_.owned_bytes(); }

 private:
  /// Entries of a list of all poses, those of one together.
  template <class Entry>
  struct ByPose {
    std::vector<Entry> entries;
    std::vector<std::uint32_t> begin;  ///< of each pose, and the end
    std::span<const Entry> of(std::size_t pose) const {
      return std::span(entries).subspan(begin[pose], begin[pose + 1] - begin[pose]);
    }
  };

  Result<void> make_buffers();
  Result<void> record();
  template <class Body>
  Result<std::unique_ptr<CommandRecorder>> recorded(Body&& body);
  Result<void> submit(const std::unique_ptr<CommandRecorder>& commands, std::size_t fields);
  void finish(const FrameState& overflow);
  void read(std::span<const GridPose> poses);
  void read_pose(std::size_t number, const GridPose& asked);
  void grow(const std::array<std::uint32_t, kListCount>& asked, FrameState overflow);
  template <class Entry, class Pose>
  void group(std::int32_t binding, std::uint32_t list, Pose pose, ByPose<Entry>& out);

  VulkanDevice& device_;
  const SceneGeometry& geometry_;
  const PreparedScene& scene_;
  const Plan plan_;
  const std::uint32_t flags_;
  FrameCapacity capacity_;
  FrameBuffers buffers_;
  std::unique_ptr<FrameDetection> detection_;
  std::optional<FrameField> field_;
  std::unique_ptr<CommandRecorder> commands_;
  std::unique_ptr<CommandRecorder> touch_commands_;  ///< of touch(); null before the first
  std::vector<const ComputePipeline*> pipelines_;
  std::size_t most_ = 0;
  bool tables_clear_ = false;
  DeviceWork work_;
  std::vector<CommandRecorder::StageTime> times_;

  std::vector<GridPose> asked_;            ///< those within the lattice
  std::vector<std::size_t> touch_places_;  ///< of touch(): theirs among all
  std::vector<FrameInput> inputs_;
  FrameDecoder decoder_;
  FrameResult result_{};  ///< of one pose, for the decoder
  ByPose<StaticResult> statics_;
  ByPose<MobileResult> mobiles_;
};

Result<void> RecordedGrid::make(const std::map<std::string, std::uint32_t>& first_capacity) {
  most_ = device_.shares_memory() ? kPosesOfProcessor : kPosesOfGpu;
  const auto poses = static_cast<std::uint32_t>(most_);
  if (scene_.constants.refined == 0 || !FrameDetection::keys_fit(scene_.constants, poses))
    return Error{ErrorCode::kInternal, "no grid of poses is for such a scene"};
  capacity_ = FrameCapacity::first_of_batch(poses, first_capacity);
  name_scene(scene_, buffers_);
  detection_ = FrameDetection::make(geometry_, scene_, plan_, true);
  if (auto r = detection_->make_shaders(device_); !r) return r;
  auto field = FrameField::create(device_, geometry_, scene_, plan_, true);
  if (!field) return field.error();
  field_.emplace(std::move(*field));
  if (auto r = make_buffers(); !r) return r;
  if (auto r = record(); !r) return r;
  return warm_up(device_, pipelines_);
}

Result<void> RecordedGrid::make_buffers() {
  tables_clear_ = false;
  if (auto r = detection_->make_buffers(device_, geometry_, scene_, capacity_, buffers_); !r) return r;
  return field_->make_buffers(device_, capacity_, buffers_);
}

/// A command buffer with what `body(FrameRecorder&)` records behind the search and the sets.
template <class Body>
Result<std::unique_ptr<CommandRecorder>> RecordedGrid::recorded(Body&& body) {
  times_.reserve(kStages);
  auto commands = CommandRecorder::create(device_, kStages);
  if (!commands) return commands.error();
  auto out = std::make_unique<CommandRecorder>(std::move(*commands));
  out->begin();
  FrameRecorder recorder(*out, buffers_);
  FrameDetection::record_anew(recorder);
  recorder.barrier();
  detection_->record(recorder);
  recorder.barrier();
  body(recorder);
  pipelines_ = recorder.used();
  if (auto r = out->end(); !r) return r.error();
  return out;
}

Result<void> RecordedGrid::record() {
  commands_.reset();
  touch_commands_.reset();
  auto commands = recorded([&](FrameRecorder& recorder) { field_->record(recorder); });
  if (!commands) return commands.error();
  commands_ = std::move(*commands);
  return {};
}

/// Of `inputs_`. `fields`: words of the fields of all poses that the last stage hands out.
Result<void> RecordedGrid::submit(const std::unique_ptr<CommandRecorder>& commands, std::size_t fields) {
  if (!tables_clear_)
    if (auto r = buffers_.clear_tables(device_); !r) return r;
  tables_clear_ = false;  // until the batch has run to its end
  const auto count = static_cast<std::uint32_t>(inputs_.size());
  BatchLists lists{};
  for (std::size_t i = 0; i < kListCount; ++i) lists.anew.lists[i].capacity = capacity_.lists[i];
  lists.anew.lists[kListPoses].count = count;
  lists.anew.result = dispatch_of_items(
      static_cast<std::uint32_t>(std::max({fields, inputs_.size(), std::size_t{kListCount}})));
  lists.cull = {detection_->cull_groups(), count, 1};
  buffers_[kBindBatchInputs].write(0, inputs_.data(), inputs_.size() * sizeof inputs_[0]);
  buffers_[kBindListsAnew].write(0, &lists, sizeof lists);
  work_.bytes_up += inputs_.size() * sizeof inputs_[0] + sizeof lists;
  if (!commands) return Error{ErrorCode::kInternal, "the batch could not be recorded when it was enlarged"};
  if (auto r = commands->submit(); !r) return r;
  if (auto r = commands->wait(); !r) return r;
  ++work_.submissions;
  work_.dispatches += commands->dispatches();
  work_.barriers += commands->barriers();
  return commands->times(times_);
}

/// Counting sort of a list that the device has written, by pose.
template <class Entry, class Pose>
void RecordedGrid::group(std::int32_t binding, std::uint32_t list, Pose pose, ByPose<Entry>& out) {
  const std::uint32_t count =
      std::min(buffers_[kBindResult].as<FrameResult>()->asked[list], capacity_.lists[list]);
  const std::span<const Entry> from(buffers_[binding].as<Entry>(), count);
  out.begin.assign(asked_.size() + 2, 0);
  for (const Entry& entry : from) ++out.begin[pose(entry) + 2];
  for (std::size_t i = 2; i < out.begin.size(); ++i) out.begin[i] += out.begin[i - 1];
  out.entries.resize(count);
  for (const Entry& entry : from) out.entries[out.begin[pose(entry) + 1]++] = entry;
  work_.bytes_down += count * sizeof(Entry);
}

void RecordedGrid::read_pose(std::size_t number, const GridPose& asked) {
  Contacts& out = *asked.out;
  const FrameState& state = buffers_[kBindResultStates].as<FrameState>()[number];
  std::span<const StaticResult> statics;
  std::span<const MobileResult> mobiles;
  if (plan_.telemetry) {
    statics = statics_.of(number);
    mobiles = mobiles_.of(number);
  }
  result_.state = state;
  result_.pair_count = state.pairs;
  result_.static_count = static_cast<std::uint32_t>(statics.size());
  result_.mobile_count = static_cast<std::uint32_t>(mobiles.size());
  decoder_.decode({.result = &result_,
                   .statics = statics.data(),
                   .mobiles = mobiles.data(),
                   .members = nullptr,
                   .areas = false},
                  out);
  out.flags |= flags_;
  if (!out.contact || out.truncated) return;
  decode_field(buffers_[kBindResultField].as<FieldWork>()[number], out);
  work_.bytes_down += sizeof(FieldWork);
  if (!out.lists) return;
  const auto* carriers = buffers_[kBindResultCarriers].as<CarrierWork>();
  for (const StaticResult& one : statics) add_carrier(one, carriers[one.zone], out);
  order_carriers(out);
  work_.bytes_down += out.carriers.size() * sizeof(CarrierWork);
  gather_areas(geometry_, asked.pose, out);
}

void RecordedGrid::read(std::span<const GridPose> poses) {
  if (plan_.telemetry) {
    group(
        kBindResultStatics, kListContactStatics, [](const StaticResult& s) { return s.area; }, statics_);
    group(
        kBindResultMobiles, kListContactMobiles,
        [](const MobileResult& m) { return m.state >> kResultPoseShift; }, mobiles_);
  }
  work_.bytes_down += poses.size() * sizeof(FrameState) + sizeof FrameResult::asked;
  const auto* states = buffers_[kBindResultStates].as<FrameState>();
  FrameState overflow{};
  for (std::size_t i = 0; i < poses.size(); ++i) {
    overflow.overflow |= states[i].overflow;
    overflow.overflow_other |= states[i].overflow_other;
    read_pose(i, poses[i]);
    for (const auto& stage : times_)
      poses[i].out->times.push_back({stage.name, stage.us / static_cast<double>(poses.size())});
  }
  finish(overflow);
}

/// `overflow`: of all poses together.
void RecordedGrid::finish(const FrameState& overflow) {
  tables_clear_ = (overflow.overflow | overflow.overflow_other) == 0;
  if (overflow.overflow == 0) return;
  std::array<std::uint32_t, kListCount> asked{};
  std::copy_n(buffers_[kBindResult].as<FrameResult>()->asked, kListCount, asked.begin());
  grow(asked, overflow);
}

/// More room for the next submission, or fewer poses in it.
void RecordedGrid::grow(const std::array<std::uint32_t, kListCount>& asked, FrameState overflow) {
  const FrameCapacity before = capacity_;
  capacity_.grow(overflow, asked);
  const bool allowed = *std::max_element(capacity_.lists.begin(), capacity_.lists.end()) <= kMostItemsOfList;
  if (!allowed || !make_buffers()) {
    // Buffers that have grown already do no harm: the lists' capacities are what counts.
    capacity_ = before;
    most_ = std::max<std::size_t>(most_ / 2, 1);
  }
  if (!record()) commands_.reset();
}

Result<void> RecordedGrid::ask(std::span<const GridPose> poses) {
  const auto start = Clock::now();
  asked_.clear();
  for (const GridPose& one : poses) {
    one.out->times.clear();
    decoder_.clear(*one.out);
    begin_answer(plan_, *one.out);
    if (!one.pose.beyond_lattice) asked_.push_back(one);
  }
  if (asked_.empty()) return {};
  inputs_.clear();
  for (const GridPose& asked : asked_) {
    inputs_.push_back(frame_input(asked.pose));
    inputs_.back().coarser = asked.coarser;
  }
  const auto submitted = Clock::now();
  const Result<void> done = submit(commands_, asked_.size() * kFieldWords);
  const double waited = us_since(submitted);
  if (done) read(asked_);
  work_.host_us += us_since(start) - waited;
  return done;
}

Result<void> RecordedGrid::touch(std::span<const LatticePose> poses, std::span<std::uint8_t> bits) {
  const auto start = Clock::now();
  touch_places_.clear();
  inputs_.clear();
  for (std::size_t i = 0; i < poses.size(); ++i) {
    bits[i] = 0;
    if (poses[i].beyond_lattice) continue;
    touch_places_.push_back(i);
    inputs_.push_back(frame_input(poses[i]));
  }
  if (inputs_.empty()) return {};
  if (!touch_commands_) {
    auto commands = recorded([&](FrameRecorder& recorder) { field_->record_touch(recorder); });
    if (!commands) return commands.error();
    touch_commands_ = std::move(*commands);
  }
  const auto submitted = Clock::now();
  const Result<void> done = submit(touch_commands_, 0);
  const double waited = us_since(submitted);
  if (done) {
    const auto* states = buffers_[kBindResultStates].as<FrameState>();
    FrameState overflow{};
    for (std::size_t k = 0; k < touch_places_.size(); ++k) {
      overflow.overflow |= states[k].overflow;
      overflow.overflow_other |= states[k].overflow_other;
      const bool open = (states[k].overflow | states[k].overflow_other) != 0;
      bits[touch_places_[k]] = open ? kOpen : static_cast<std::uint8_t>(states[k].contact);
    }
    work_.bytes_down += touch_places_.size() * sizeof(FrameState) + sizeof FrameResult::asked;
    finish(overflow);
  }
  work_.host_us += us_since(start) - waited;
  return done;
}

}  // namespace

Result<std::unique_ptr<PoseGrid>> PoseGrid::create(VulkanDevice& device, const SceneGeometry& geometry,
                                                   const PreparedScene& scene,
                                                   const std::map<std::string, std::uint32_t>& first_capacity,
                                                   const Plan& plan) {
  auto out = std::make_unique<RecordedGrid>(device, geometry, scene, plan);
  if (auto r = out->make(first_capacity); !r) return r.error();
  return std::unique_ptr<PoseGrid>(std::move(out));
}

}  // namespace palpate

#include "compute/gpu/frame/frame.h"

#include <algorithm>
#include <array>
#include <chrono>
#include <cstring>
#include <optional>
#include <span>
#include <utility>
#include <vector>

#include "compute/gpu/frame/capacity.h"
#include "compute/gpu/frame/decode.h"
#include "compute/gpu/frame/detection.h"
#include "compute/gpu/frame/field.h"
#include "compute/gpu/frame/plan.h"
#include "compute/gpu/frame/recorder.h"
#include "compute/gpu/frame/response.h"
#include "compute/gpu/frame/scene_buffers.h"
#include "compute/gpu/frame/stage_memory.h"
#include "compute/vulkan/command_recorder.h"
#include "model/contact/contact_areas.h"

namespace palpate {
namespace {

using Clock = std::chrono::steady_clock;

double us_since(Clock::time_point from) {
  return std::chrono::duration<double, std::micro>(Clock::now() - from).count();
}

class RecordedFrame final : public Frame {
 public:
  RecordedFrame(VulkanDevice& device, const SceneGeometry& geometry, const PreparedScene& scene,
                const Plan& plan)
      : device_(device),
        geometry_(geometry),
        scene_(scene),
        plan_(frame_plan(plan, scene.mockup.partition.has_internal)) {}

  Result<void> make(const std::map<std::string, std::uint32_t>& first_capacity);
  Result<void> finish() override;
  Result<void> query(const LatticePose& pose, const Ignored* ignored, Contacts& out) override;
  Result<std::vector<std::pair<std::uint32_t, std::uint32_t>>> pairs() const override;
  Result<void> enlarge() override;
  Result<void> time_stages(bool wanted) override;
  DeviceWork work() const override { return work_; }
  std::uint64_t memory_bytes() const override { return buffers_.owned_bytes(); }
  std::vector<StageMemory> memory_by_stage() const override { return stage_memory(buffers_, plan_.zones); }

 private:
  Result<void> make_pipelines();
  Result<void> make_buffers();
  Result<void> set_capacities();
  Result<void> clear();
  Result<void> record();
  Result<void> record_again() { return finished_ ? record() : Result<void>{}; }
  template <class Body>
  Result<std::unique_ptr<CommandRecorder>> recorded(Body&& body);
  Result<void> answer(const LatticePose& pose, const Ignored* ignored, Contacts& out);
  Result<void> run(CommandRecorder& commands, Contacts& out);
  void read(Contacts& out);
  void write_input(const LatticePose& pose, const Ignored* ignored);

  VulkanDevice& device_;
  const SceneGeometry& geometry_;
  const PreparedScene& scene_;
  const Plan plan_;
  FrameCapacity capacity_;
  FrameBuffers buffers_;
  std::unique_ptr<FrameDetection> detection_;
  std::optional<FrameResponse> response_;  ///< `paper`
  std::optional<FrameField> field_;        ///< `refined`
  FrameDecoder decoder_;
  std::unique_ptr<CommandRecorder> commands_;  ///< from the pose to the result. Null after a failed record()
  double waited_us_ = 0, staged_us_ = 0;       ///< of this query's submissions
  DeviceWork work_;
  std::vector<const ComputePipeline*> pipelines_;
  std::vector<CommandRecorder::StageTime> times_;
  bool timed_ = false;     ///< stages' times are wanted though nobody watches
  bool finished_ = false;  ///< pipelines are there and commands recorded
  bool tables_clear_ = false;
  std::uint64_t pairs_ = 0;        ///< that the last query counted
  std::uint32_t frame_flags_ = 0;  ///< of every frame within the lattice
};

Result<void> RecordedFrame::make(const std::map<std::string, std::uint32_t>& first_capacity) {
  name_scene(scene_, buffers_);
  const gpu::SceneConstants& constants = scene_.constants;
  frame_flags_ = flags_of_frames(constants);
  detection_ = FrameDetection::make(geometry_, scene_, plan_);
  if (auto r = make_pipelines(); !r) return r;
  std::optional<std::uint64_t> samples;
  if (scene_.sample_ids && constants.tool_has_inside != 0)
    samples = scene_.sample_ids.bytes() / sizeof(std::uint32_t);
  const WorkCut cut = work_cut(device_, false);
  capacity_ = FrameCapacity::first({.scene = constants, .cut = cut, .samples = samples}, first_capacity);
  if (auto r = make_buffers(); !r) return r;
  return finish();
}

/// Asks for them: they are made by other threads.
Result<void> RecordedFrame::make_pipelines() {
  if (auto r = detection_->make_shaders(device_); !r) return r;
  if (scene_.constants.refined != 0) {
    auto field = FrameField::create(device_, geometry_, scene_, plan_);
    if (!field) return field.error();
    field_.emplace(std::move(*field));
    return {};
  }
  auto response = FrameResponse::create(device_, plan_);
  if (!response) return response.error();
  response_.emplace(std::move(*response));
  return {};
}

Result<void> RecordedFrame::finish() {
  if (finished_) return {};
  if (auto r = record(); !r) return r;
  if (auto r = warm_up(device_, pipelines_); !r) return r;  // no frame of a loop should wait for a compiler
  finished_ = true;
  return {};
}

Result<void> RecordedFrame::make_buffers() {
  if (auto r = detection_->make_buffers(device_, geometry_, scene_, capacity_, buffers_); !r) return r;
  if (response_)
    if (auto r = response_->make_buffers(device_, scene_.constants.tool.triangles, capacity_, buffers_); !r)
      return r;
  if (field_)
    if (auto r = field_->make_buffers(device_, capacity_, buffers_); !r) return r;
  return set_capacities();
}

Result<void> RecordedFrame::set_capacities() {
  std::array<gpu::FrameList, gpu::kListCount> lists{};
  for (std::size_t i = 0; i < gpu::kListCount; ++i) lists[i].capacity = capacity_.lists[i];
  const gpu::DispatchArguments result = dispatch_of_items(field_ ? gpu::kFieldWords : 1);
  if (auto r = upload(device_, buffers_[gpu::kBindResultGroups], &result, sizeof result); !r) return r;
  return upload(device_, buffers_[gpu::kBindFrameLists], lists.data(), sizeof lists);
}

/// All that is 0 between frames.
Result<void> RecordedFrame::clear() {
  if (auto r = set_capacities(); !r) return r;
  return buffers_.clear_tables(device_);
}

Result<void> RecordedFrame::enlarge() {
  // What was asked for, list by list; the result has not been touched since the frame that overflowed.
  std::array<std::uint32_t, gpu::kListCount> asked{};
  std::copy_n(buffers_[gpu::kBindResult].as<gpu::FrameResult>()->asked, gpu::kListCount, asked.begin());
  const gpu::FrameState state = buffers_[gpu::kBindResult].as<gpu::FrameResult>()->state;
  const FrameCapacity before = capacity_;
  if (!capacity_.grow(state, asked)) return bad_value(fixed_limit(state));
  tables_clear_ = false;
  if (auto made = make_buffers(); !made) {
    // Buffers that have grown already do no harm: the lists' capacities are what counts.
    capacity_ = before;
    if (auto r = set_capacities(); !r) return r;
    if (auto r = record_again(); !r) return r;
    return made;
  }
  return record_again();
}

/// A command buffer with what `body(FrameRecorder&)` records.
template <class Body>
Result<std::unique_ptr<CommandRecorder>> RecordedFrame::recorded(Body&& body) {
  constexpr std::uint32_t kStages = 32;  // most calls of stage()
  times_.reserve(kStages);
  auto commands = CommandRecorder::create(device_, plan_.telemetry || timed_ ? kStages : 0);
  if (!commands) return commands.error();
  auto out = std::make_unique<CommandRecorder>(std::move(*commands));
  out->begin();
  FrameRecorder recorder(*out, buffers_);
  body(recorder);
  pipelines_.insert(pipelines_.end(), recorder.used().begin(), recorder.used().end());
  if (auto r = out->end(); !r) return r.error();
  return out;
}

Result<void> RecordedFrame::record() {
  commands_.reset();
  pipelines_.clear();
  auto commands = recorded([&](FrameRecorder& recorder) {
    detection_->record(recorder);
    recorder.barrier();
    if (field_) {
      field_->record(recorder);
    } else {
      detection_->record_names(recorder);
      recorder.barrier();
      response_->record(recorder);
      recorder.barrier();
      detection_->record_end(recorder);
    }
  });
  if (!commands) return commands.error();
  commands_ = std::move(*commands);
  return {};
}

Result<void> RecordedFrame::time_stages(bool wanted) {
  if (timed_ == wanted) return {};
  timed_ = wanted;
  return record_again();
}

void RecordedFrame::write_input(const LatticePose& pose, const Ignored* ignored) {
  gpu::FrameInput input = frame_input(pose);
  if (field_) input.ignores = field_->ignore(ignored, buffers_) ? 1 : 0;
  input.coarser = ignored != nullptr ? ignored->coarser : 0;
  buffers_[gpu::kBindFrameInput].write(0, &input, sizeof input);
  work_.bytes_up += sizeof input;
}

Result<void> RecordedFrame::query(const LatticePose& pose, const Ignored* ignored, Contacts& out) {
  const auto start = Clock::now();
  waited_us_ = staged_us_ = 0;
  const Result<void> answered = answer(pose, ignored, out);
  work_.host_us += us_since(start) - waited_us_;
  return answered;
}

Result<void> RecordedFrame::answer(const LatticePose& pose, const Ignored* ignored, Contacts& out) {
  out.times.clear();
  decoder_.clear(out);
  pairs_ = 0;
  begin_answer(plan_, out);
  if (pose.beyond_lattice) return {};
  out.flags = frame_flags_;
  if (auto r = finish(); !r) return r;
  if (!tables_clear_)
    if (auto r = clear(); !r) return r;
  tables_clear_ = false;  // until the frame has run to its end
  const auto writing = Clock::now();
  write_input(pose, ignored);
  out.times.push_back({"upload", us_since(writing)});

  if (!commands_) return Error{ErrorCode::kInternal, "the frame could not be recorded when it was enlarged"};
  if (auto r = run(*commands_, out); !r) return r;
  // What waiting cost beyond the stages themselves, or in all.
  out.times.push_back({times_.empty() ? "device" : "submit", std::max(0.0, waited_us_ - staged_us_)});
  const auto finished = Clock::now();
  read(out);
  out.times.push_back({"readback", us_since(finished)});
  if (field_ && out.contact && out.lists && !out.truncated) {
    const auto gathering = Clock::now();
    gather_areas(geometry_, pose, out);
    out.times.push_back({"areas", us_since(gathering)});
  }
  return {};
}

/// Submits, waits, and notes the stages' times.
Result<void> RecordedFrame::run(CommandRecorder& commands, Contacts& out) {
  const auto submitted = Clock::now();
  if (auto r = commands.submit(); !r) return r;
  if (auto r = commands.wait(); !r) return r;
  ++work_.submissions;
  work_.dispatches += commands.dispatches();
  work_.barriers += commands.barriers();
  waited_us_ += us_since(submitted);
  if (auto r = commands.times(times_); !r) return r;
  for (const auto& stage : times_) {
    out.times.push_back({stage.name, stage.us});
    staged_us_ += stage.us;
  }
  return {};
}

/// What the device left in mapped memory.
void RecordedFrame::read(Contacts& out) {
  const auto* result = buffers_[gpu::kBindResult].as<gpu::FrameResult>();
  decoder_.decode({.result = result,
                   .statics = buffers_[gpu::kBindResultStatics].as<gpu::StaticResult>(),
                   .mobiles = buffers_[gpu::kBindResultMobiles].as<gpu::MobileResult>(),
                   .members = buffers_[gpu::kBindResultMembers].as<gpu::AreaMember>(),
                   .areas = scene_.constants.refined == 0},
                  out);
  pairs_ = out.pairs;
  out.flags |= frame_flags_;
  if (field_ && out.contact && !out.truncated) field_->decode(buffers_, *result, out);
  work_.bytes_down += offsetof(gpu::FrameResult, areas) + result->area_count * sizeof(gpu::AreaResult);
  if (out.lists || response_) work_.bytes_down += result->static_count * sizeof(gpu::StaticResult);
  if (out.lists)
    work_.bytes_down +=
        result->mobile_count * sizeof(gpu::MobileResult) + result->member_count * sizeof(gpu::AreaMember);
  if (field_ && out.contact)
    work_.bytes_down +=
        sizeof(gpu::FieldWork) + (out.lists ? result->static_count * sizeof(gpu::CarrierWork) : 0);
  tables_clear_ = !out.truncated;
}

Result<std::vector<std::pair<std::uint32_t, std::uint32_t>>> RecordedFrame::pairs() const {
  std::vector<gpu::ContactPair> found(pairs_);
  if (auto r = download(device_, buffers_[gpu::kBindPairs], 0, found.data(),
                        found.size() * sizeof(gpu::ContactPair));
      !r)
    return r.error();
  std::vector<std::pair<std::uint32_t, std::uint32_t>> out;
  out.reserve(found.size());
  for (const gpu::ContactPair& pair : found) out.emplace_back(pair.static_id, pair.mobile);
  std::sort(out.begin(), out.end());
  return out;
}

}  // namespace

Result<std::unique_ptr<Frame>> Frame::create(VulkanDevice& device, const SceneGeometry& geometry,
                                             const PreparedScene& scene,
                                             const std::map<std::string, std::uint32_t>& first_capacity,
                                             const Plan& plan) {
  auto out = std::make_unique<RecordedFrame>(device, geometry, scene, plan);
  if (auto r = out->make(first_capacity); !r) return r.error();
  return std::unique_ptr<Frame>(std::move(out));
}

}  // namespace palpate

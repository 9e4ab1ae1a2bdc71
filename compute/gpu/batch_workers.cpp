#include "compute/gpu/batch_workers.h"

#include <utility>

namespace palpate {
namespace {

/// Answers a pose, with more room where the frame has too little.
Result<void> answer_pose(Frame& frame, const LatticePose& pose, Contacts& out) {
  for (;;) {
    if (auto answered = frame.query(pose, nullptr, out); !answered || !out.truncated) return answered;
    if (!frame.enlarge()) return {};   // truncated it stays
  }
}

}  // namespace

Result<std::unique_ptr<BatchWorkers>> BatchWorkers::create(const GpuOptions& options, VulkanDevice* device, const SceneGeometry& geometry, const PreparedScene& scene,
                                                           const Plan& plan, unsigned helpers) {
  std::unique_ptr<BatchWorkers> out(new BatchWorkers);
  for (unsigned i = 0; i < helpers; ++i) {
    auto helper = std::make_unique<Helper>();
    if (device == nullptr) {
      auto made = VulkanDevice::create(options);
      if (!made) return made.error();
      helper->device = std::move(*made);
      auto shared = share_scene(*helper->device, scene);
      if (!shared) return shared.error();
      helper->scene = std::move(*shared);
    }
    auto frame = device == nullptr ? Frame::create(*helper->device, geometry, helper->scene, options.first_capacity, plan)
                                   : Frame::create(*device, geometry, scene, options.first_capacity, plan);
    if (!frame) return frame.error();
    helper->frame = std::move(*frame);
    out->helpers_.push_back(std::move(helper));
  }
  // Threads last: making a device reads the environment.
  std::vector<PoseThreads::Answer> answers;
  for (const auto& helper : out->helpers_) answers.push_back([&frame = *helper->frame](const LatticePose& pose, Contacts& contacts) { return answer_pose(frame, pose, contacts); });
  out->threads_.emplace(std::move(answers));
  return out;
}

BatchWorkers::~BatchWorkers() {
  threads_.reset();
  // Frames go before the scenes they name, scenes before their devices.
  for (const auto& helper : helpers_) {
    helper->frame.reset();
    helper->scene = {};
  }
}

std::uint64_t BatchWorkers::memory_bytes() const {
  std::uint64_t sum = 0;
  for (const auto& helper : helpers_) sum += helper->frame->memory_bytes();
  return sum;
}

Result<void> BatchWorkers::answer(Frame& own, std::span<const LatticePose> poses, std::span<Contacts> out) {
  return threads_->answer([&](const LatticePose& pose, Contacts& contacts) { return answer_pose(own, pose, contacts); }, poses, out);
}

}  // namespace palpate

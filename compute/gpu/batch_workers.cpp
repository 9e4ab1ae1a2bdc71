#include "compute/gpu/batch_workers.h"

#include <utility>

namespace palpate {
namespace {

/// Answers poses by a frame, with more room where that has too little.
class RoomyFrame final : public PoseQuery {
 public:
  explicit RoomyFrame(Frame& frame) : frame_(frame) {}
  Result<void> query(const LatticePose& pose, const Ignored* ignored, Contacts& out) override {
    for (;;) {
      if (auto answered = frame_.query(pose, ignored, out); !answered || !out.truncated) return answered;
      if (!frame_.enlarge()) return {};  // truncated it stays
    }
  }

 private:
  Frame& frame_;
};

}  // namespace

Result<std::unique_ptr<BatchWorkers>> BatchWorkers::create(const GpuOptions& options, VulkanDevice* device,
                                                           const SceneGeometry& geometry,
                                                           const PreparedScene& scene, const Plan& plan,
                                                           unsigned helpers) {
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
    auto frame = device == nullptr
                     ? Frame::create(*helper->device, geometry, helper->scene, options.first_capacity, plan)
                     : Frame::create(*device, geometry, scene, options.first_capacity, plan);
    if (!frame) return frame.error();
    helper->frame = std::move(*frame);
    out->helpers_.push_back(std::move(helper));
  }
  // Threads last: making a device reads the environment.
  std::vector<PoseQuery*> asked;
  for (const auto& helper : out->helpers_) {
    helper->asked = std::make_unique<RoomyFrame>(*helper->frame);
    asked.push_back(helper->asked.get());
  }
  out->threads_.emplace(std::move(asked));
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

DeviceWork BatchWorkers::work() const {
  DeviceWork sum;
  for (const auto& helper : helpers_) sum += helper->frame->work();
  return sum;
}

Result<void> BatchWorkers::share(Frame& own, std::size_t count, const PoseWork& work) {
  RoomyFrame asked(own);
  return threads_->share(asked, count, work);
}

}  // namespace palpate

#include "compute/gpu/batch_workers.h"

#include <algorithm>
#include <utility>

namespace palpate {
namespace {

constexpr std::size_t kMostAtOnce = 8;   // poses that a thread takes at a time (chosen: less handing over; few, so that all end together)

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
  for (const auto& helper : out->helpers_) helper->thread = std::thread([&workers = *out, &frame = *helper->frame] { workers.serve(frame); });
  return out;
}

BatchWorkers::~BatchWorkers() {
  {
    const std::lock_guard lock(mutex_);
    stop_ = true;
  }
  begun_.notify_all();
  for (const auto& helper : helpers_)
    if (helper->thread.joinable()) helper->thread.join();
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

/// Takes poses until none is left.
void BatchWorkers::work(Frame& frame) {
  const std::size_t threads = helpers_.size() + 1;
  for (;;) {
    std::size_t first = 0, last = 0;
    {
      const std::lock_guard lock(mutex_);
      if (next_ == poses_.size()) return;
      first = next_;
      last = next_ += std::clamp<std::size_t>((poses_.size() - next_) / (2 * threads), 1, kMostAtOnce);
    }
    for (std::size_t i = first; i < last; ++i) {
      auto answered = answer_pose(frame, poses_[i], out_[i]);
      if (answered) continue;
      const std::lock_guard lock(mutex_);
      if (outcome_) outcome_ = std::move(answered);
      next_ = poses_.size();
      return;
    }
  }
}

void BatchWorkers::serve(Frame& frame) {
  std::uint64_t seen = 0;
  std::unique_lock lock(mutex_);
  for (;;) {
    begun_.wait(lock, [&] { return stop_ || round_ != seen; });
    if (stop_) return;
    seen = round_;
    lock.unlock();
    work(frame);
    lock.lock();
    if (--busy_ == 0) finished_.notify_one();
  }
}

Result<void> BatchWorkers::answer(Frame& own, std::span<const LatticePose> poses, std::span<Contacts> out) {
  {
    const std::lock_guard lock(mutex_);
    poses_ = poses;
    out_ = out;
    next_ = 0;
    outcome_ = {};
    busy_ = helpers_.size();
    ++round_;
  }
  begun_.notify_all();
  work(own);
  std::unique_lock lock(mutex_);
  finished_.wait(lock, [&] { return busy_ == 0; });
  return outcome_;
}

}  // namespace palpate

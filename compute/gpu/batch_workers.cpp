#include "compute/gpu/batch_workers.h"

#include <algorithm>
#include <span>
#include <utility>

namespace palpate {
namespace {

/// How a batch is cut (all chosen): pieces for each thread, so that all end together; and poses that are
/// worth a submission, which on a GPU costs what dozens of poses do.
struct Cut {
  std::size_t pieces_of_thread, least;
};
constexpr Cut kOfProcessors{.pieces_of_thread = 4, .least = 32}, kOfGpu{.pieces_of_thread = 2, .least = 256};

}  // namespace

/// Answers poses by a frame, with more room where that has too little; many together by a grid.
class BatchWorkers::Asked final : public PoseQuery {
 public:
  Asked(Frame& frame, std::unique_ptr<PoseGrid> grid) : frame_(frame), grid_(std::move(grid)) {}

  Result<void> query(const LatticePose& pose, const Ignored* ignored, Contacts& out) override {
    for (;;) {
      if (auto answered = frame_.query(pose, ignored, out); !answered || !out.truncated) return answered;
      if (!frame_.enlarge()) return {};  // truncated it stays
    }
  }

  Result<void> query_together(std::span<const LatticePose> poses, std::span<Contacts* const> out) override {
    if (!grid_) return PoseQuery::query_together(poses, out);
    for (std::size_t first = 0, count = 0; first < poses.size(); first += count) {
      count = std::min(grid_->most(), poses.size() - first);
      asked_.clear();
      for (std::size_t i = first; i < first + count; ++i) asked_.push_back({poses[i], 0, out[i]});
      if (auto answered = grid_->ask(asked_); !answered) return answered;
      // What the grid had no room for is asked again alone.
      for (const GridPose& one : asked_)
        if (one.out->truncated)
          if (auto answered = query(one.pose, nullptr, *one.out); !answered) return answered;
    }
    return {};
  }

  Result<void> touch_together(std::span<const LatticePose> poses, std::span<std::uint8_t> bits) override {
    if (!grid_) return PoseQuery::touch_together(poses, bits);
    for (std::size_t first = 0, count = 0; first < poses.size(); first += count) {
      count = std::min(grid_->most(), poses.size() - first);
      const auto to = bits.subspan(first, count);
      if (auto answered = grid_->touch(poses.subspan(first, count), to); !answered) return answered;
      for (std::size_t i = 0; i < count; ++i)
        if (to[i] == PoseGrid::kOpen)
          if (auto answered = PoseQuery::touch_together(poses.subspan(first + i, 1), to.subspan(i, 1));
              !answered)
            return answered;
    }
    return {};
  }

  const PoseGrid* grid() const { return grid_.get(); }

 private:
  Frame& frame_;
  std::unique_ptr<PoseGrid> grid_;  ///< may be null
  std::vector<GridPose> asked_;
};

BatchWorkers::BatchWorkers() = default;

Result<std::unique_ptr<BatchWorkers>> BatchWorkers::create(const GpuOptions& options, VulkanDevice& device,
                                                           bool own_devices, const SceneGeometry& geometry,
                                                           const PreparedScene& scene, const Plan& plan,
                                                           Frame& own, unsigned helpers) {
  const auto grid_on = [&](VulkanDevice& on, const PreparedScene& of) -> std::unique_ptr<PoseGrid> {
    auto made = PoseGrid::create(on, geometry, of, options.first_capacity, plan);
    return made ? std::move(*made) : nullptr;  // then it goes pose by pose
  };
  std::unique_ptr<BatchWorkers> out(new BatchWorkers);
  out->own_devices_ = own_devices;
  out->own_ = std::make_unique<Asked>(own, grid_on(device, scene));
  for (unsigned i = 0; i < helpers; ++i) {
    auto helper = std::make_unique<Helper>();
    if (own_devices) {
      auto made = VulkanDevice::create(options);
      if (!made) return made.error();
      helper->device = std::move(*made);
      auto shared = share_scene(*helper->device, scene);
      if (!shared) return shared.error();
      helper->scene = std::move(*shared);
    }
    VulkanDevice& on = own_devices ? *helper->device : device;
    const PreparedScene& of = own_devices ? helper->scene : scene;
    auto frame = Frame::create(on, geometry, of, options.first_capacity, plan);
    if (!frame) return frame.error();
    helper->frame = std::move(*frame);
    helper->asked = std::make_unique<Asked>(*helper->frame, grid_on(on, of));
    out->helpers_.push_back(std::move(helper));
  }
  // Threads last: making a device reads the environment.
  std::vector<PoseQuery*> asked;
  for (const auto& helper : out->helpers_) asked.push_back(helper->asked.get());
  out->threads_.emplace(std::move(asked));
  return out;
}

BatchWorkers::~BatchWorkers() {
  threads_.reset();
  // Grids and frames go before the scenes they name, scenes before their devices.
  for (const auto& helper : helpers_) {
    helper->asked.reset();
    helper->frame.reset();
    helper->scene = {};
  }
}

std::uint64_t BatchWorkers::memory_bytes() const {
  std::uint64_t sum = own_->grid() != nullptr ? own_->grid()->memory_bytes() : 0;
  for (const auto& helper : helpers_) {
    sum += helper->frame->memory_bytes();
    if (const PoseGrid* grid = helper->asked->grid()) sum += grid->memory_bytes();
  }
  return sum;
}

DeviceWork BatchWorkers::work() const {
  DeviceWork sum = own_->grid() != nullptr ? own_->grid()->work() : DeviceWork{};
  for (const auto& helper : helpers_) {
    sum += helper->frame->work();
    if (const PoseGrid* grid = helper->asked->grid()) sum += grid->work();
  }
  return sum;
}

std::size_t BatchWorkers::poses_together(std::size_t count) const {
  if (own_->grid() == nullptr) return 1;
  const Cut& cut = own_devices_ ? kOfProcessors : kOfGpu;
  const std::size_t pieces = cut.pieces_of_thread * (helpers_.size() + 1), most = own_->grid()->most();
  return std::clamp((count + pieces - 1) / pieces, std::min(cut.least, most), most);
}

Result<void> BatchWorkers::share(std::size_t count, const PoseWork& work) {
  return count == 1 ? work(*own_, 0) : threads_->share(*own_, count, work);
}

}  // namespace palpate

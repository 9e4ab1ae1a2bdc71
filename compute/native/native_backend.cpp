#include "compute/native/native_backend.h"

#include <unistd.h>

#include <algorithm>
#include <atomic>
#include <chrono>
#include <fstream>
#include <mutex>
#include <new>
#include <optional>
#include <string>
#include <thread>
#include <utility>
#include <vector>

#include "compute/native/frame.h"
#include "compute/native/prepare/cache.h"
#include "compute/native/prepare/scene.h"
#include "compute/native/queries/questions.h"
#include "compute/scene/estimate.h"
#include "compute/scene/shares.h"
#include "model/address_space.h"
#include "model/pose_threads.h"
#include "model/processors.h"
#include "model/shared_backend.h"

namespace palpate {
namespace {

using native::Frame;
using native::Questions;

/// "Intel(R) Xeon(R) Platinum 8481C, 2 threads"
std::string processor_name() {
  std::ifstream in("/proc/cpuinfo");
  std::string name = "processor";
  for (std::string line; std::getline(in, line);)
    if (line.starts_with("model name") && line.find(": ") != std::string::npos) {
      name = line.substr(line.find(": ") + 2);
      break;
    }
  return name + ", " + std::to_string(processors()) + " threads";
}

/// Bytes that this process may come to hold.
std::uint64_t memory_limit() {
  const auto whole =
      static_cast<std::uint64_t>(sysconf(_SC_PHYS_PAGES)) * static_cast<std::uint64_t>(sysconf(_SC_PAGESIZE));
  const auto left = address_space_left();
  return left ? std::min(whole, *left) : whole;
}

/// What the planner's questions read, made when the first of them is asked.
class QuestionTables {
 public:
  QuestionTables(const SceneGeometry& geometry, std::shared_ptr<const native::Scene> scene)
      : geometry_(geometry), scene_(std::move(scene)) {}

  const native::PairTrees& trees() const { return made().trees; }
  const native::Containment& containment() const { return made().containment; }
  std::uint64_t bytes() const {
    const std::lock_guard lock(mutex_);
    return made_ ? made_->trees.bytes() : 0;
  }

 private:
  struct Made {
    native::PairTrees trees;
    native::Containment containment;
  };
  const Made& made() const {
    const std::lock_guard lock(mutex_);
    if (!made_) made_.reset(new Made{native::PairTrees(geometry_), {geometry_, scene_->tables()}});
    return *made_;
  }

  const SceneGeometry& geometry_;
  const std::shared_ptr<const native::Scene> scene_;
  mutable std::mutex mutex_;
  mutable std::unique_ptr<const Made> made_;
};

class NativeBackend final : public CollisionBackend, public SharedBackend {
 public:
  explicit NativeBackend(std::shared_ptr<DiskCache> cache, std::string device = processor_name())
      : cache_(std::move(cache)), device_(std::move(device)) {}

  Result<void> prepare(const SceneGeometry& geometry, const Plan& plan, const Progress& progress) override {
    drop_frames();
    scene_.reset();
    if (plan.profile != Profile::kRefined)
      return bad_value("the cpu engine answers the profile refined alone; gpu and ref answer paper, too");
    if (const std::uint64_t bytes = preparation_bytes(geometry, plan), most = memory_limit(); bytes > most)
      return bad_value("preparing " + std::to_string(geometry.mockup.triangles.size()) +
                       " triangles takes up to " + std::to_string(bytes >> 20) + " MiB, more than the " +
                       std::to_string(most >> 20) + " MiB of memory that this process may have");
    try {
      if (auto found = scene_for(geometry, plan, progress); !found) return found;
      tables_ = std::make_shared<const QuestionTables>(geometry, scene_);
      begin(geometry, plan);
      frame_->share(true);
      return {};
    } catch (const std::bad_alloc&) {
      frame_.reset();
      scene_.reset();
      return Error{ErrorCode::kInternal, "there was no memory left for preparing " +
                                             std::to_string(geometry.mockup.triangles.size()) + " triangles"};
    }
  }

  Another another() const override {
    if (!frame_) return {};
    return [geometry = geometry_, plan = plan_, device = device_, scene = scene_,
            tables = tables_]() -> std::unique_ptr<CollisionBackend> {
      auto made = std::make_unique<NativeBackend>(nullptr, device);
      made->scene_ = scene;
      made->tables_ = tables;
      made->begin(*geometry, plan);  // no second thread: who wants another has threads enough
      return made;
    };
  }

  Result<void> replan(const Plan& plan) override {
    if (!frame_ || plan.profile != Profile::kRefined)
      return Error{ErrorCode::kInternal, "no scene has been prepared for this plan's profile"};
    plan_ = plan;
    frame_->replan(plan);
    for (const auto& helper : helpers_) helper->replan(plan);
    return {};
  }

  /// With what the planner's questions read, too: who asks the first of them has been told.
  std::uint64_t preparation_bytes(const SceneGeometry& geometry, const Plan& plan) const override {
    return estimate_preparation(geometry, plan) + native::most_sample_bytes(geometry) +
           native::PairTrees::most_bytes(geometry);
  }

  Result<void> query(const LatticePose& pose, const Ignored* ignored, Contacts& out) override {
    if (!frame_) return Error{ErrorCode::kInternal, "query before prepare"};
    return frame_->query(pose, ignored, out);
  }

  Result<void> share(std::size_t count, const PoseWork& work) override {
    if (!frame_) return Error{ErrorCode::kInternal, "query before prepare"};
    shared_ += count;
    if (!threads_ && shared_ >= kWorthThreads) make_helpers();
    if (!threads_ || count < 2) return CollisionBackend::share(count, work);
    frame_->share(false);  // the other processors have poses of their own
    auto done = threads_->share(*frame_, count, work);
    frame_->share(true);
    return done;
  }

  Result<void> touches(std::span<const LatticePose> poses, std::span<std::uint8_t> bits) override {
    if (!frame_) return Error{ErrorCode::kInternal, "touches before prepare"};
    ask();
    if (!threads_ && (shared_ += poses.size()) >= kWorthThreads) make_helpers();
    while (questions_.size() < 1 + helpers_.size())
      questions_.push_back(std::make_unique<Questions>(tables_->trees(), tables_->containment(),
                                                       *helpers_[questions_.size() - 1]));
    // Poses that follow each other mostly touch alike: each thread has runs of them.
    constexpr std::size_t kRunOfPoses = 64;
    std::atomic<std::size_t> next{0};
    std::mutex mutex;
    Result<void> outcome;
    const auto serve = [&](Questions& by) {
      for (std::size_t first = 0; (first = next.fetch_add(kRunOfPoses)) < poses.size();)
        for (std::size_t i = first; i < std::min(first + kRunOfPoses, poses.size()); ++i) {
          const Result<bool> answered = by.touches(poses[i]);
          if (!answered) {
            const std::lock_guard lock(mutex);
            outcome = answered.error();
            next = poses.size();
            return;
          }
          bits[i] = *answered ? 1 : 0;
        }
    };
    frame_->share(false);
    const auto threads =
        static_cast<std::uint32_t>(std::clamp<std::size_t>(poses.size() / kRunOfPoses, 1, questions_.size()));
    in_shares(
        threads, [&](std::uint32_t share) { serve(*questions_[share]); }, [](std::uint32_t) { return true; });
    frame_->share(true);
    return outcome;
  }

  Result<void> clearance(const LatticePose& pose, std::int32_t within, Clearance& out) override {
    if (!frame_) return Error{ErrorCode::kInternal, "clearance before prepare"};
    return ask().clearance(pose, within, out);
  }

  Result<void> free_time(const LatticePose& pose, ScrewMotion& motion, double time, FreeTime& out) override {
    if (!frame_) return Error{ErrorCode::kInternal, "free_time before prepare"};
    out = pose.beyond_lattice ? FreeTime{} : ask().free_time(motion, time);
    return {};
  }

  Result<VoxelPartition> partition(bool tool) const override {
    if (!scene_) return Error{ErrorCode::kInternal, "partition before prepare"};
    return dense(tool ? scene_->tool : scene_->mockup);
  }

  Result<std::vector<std::pair<std::uint32_t, std::uint32_t>>> pairs() const override {
    if (!frame_) return Error{ErrorCode::kInternal, "pairs before prepare"};
    std::vector<std::pair<std::uint32_t, std::uint32_t>> out;
    for (const gpu::ContactPair& pair : frame_->pairs()) out.emplace_back(pair.static_id, pair.mobile);
    std::sort(out.begin(), out.end());
    return out;
  }

  bool has_internal_voxels() const override { return scene_ && scene_->mockup.has_internal; }
  std::string name() const override { return "cpu"; }
  std::string device() const override { return device_; }
  std::uint64_t memory_bytes() const override {
    std::uint64_t sum = (scene_ ? scene_->bytes() : 0) + (frame_ ? frame_->memory_bytes() : 0) +
                        (tables_ ? tables_->bytes() : 0);
    for (const auto& helper : helpers_) sum += helper->memory_bytes();
    return sum;
  }

 private:
  /// Fills scene_, from the cache if it is there.
  Result<void> scene_for(const SceneGeometry& geometry, const Plan& plan, const Progress& progress) {
    const auto start = std::chrono::steady_clock::now();
    const ContentKey key = cache_ ? native::scene_key(geometry) : ContentKey{};
    if (cache_)
      if (auto found = native::find_scene(*cache_, key)) {
        found->know(geometry);
        scene_ = std::make_shared<const native::Scene>(std::move(*found));
        return {};
      }
    auto scene = native::prepare_scene(geometry, plan, progress);
    if (!scene) return scene.error();
    scene_ = std::make_shared<const native::Scene>(std::move(*scene));
    if (cache_)
      native::keep_scene(*cache_, key, *scene_,
                         std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count());
    return {};
  }
  /// Who answers the planner's questions on this thread; what they read is made when the first of them is
  /// asked.
  Questions& ask() {
    if (questions_.empty())
      questions_.push_back(std::make_unique<Questions>(tables_->trees(), tables_->containment(), *frame_));
    return *questions_.front();
  }
  /// Makes the frame that answers lone poses.
  void begin(const SceneGeometry& geometry, const Plan& plan) {
    geometry_ = &geometry;
    plan_ = plan;
    frame_.emplace(geometry, scene_->tables(), plan, scene_->open);
  }
  void drop_frames() {
    questions_.clear();
    tables_.reset();
    threads_.reset();
    helpers_.clear();
    frame_.reset();
    shared_ = 0;
  }
  /// A frame and a thread for every other processor.
  void make_helpers() {
    const unsigned cores = processors();
    std::vector<PoseQuery*> asked;
    for (unsigned i = 1; i < cores; ++i)
      asked.push_back(
          helpers_.emplace_back(std::make_unique<Frame>(*geometry_, scene_->tables(), plan_, scene_->open))
              .get());
    threads_.emplace(std::move(asked));
  }

  const std::shared_ptr<DiskCache> cache_;  ///< may be null
  const std::string device_;
  const SceneGeometry* geometry_ = nullptr;  ///< of scene_
  Plan plan_;                                ///< of frame_
  std::shared_ptr<const native::Scene> scene_;
  std::optional<Frame> frame_;
  std::vector<std::unique_ptr<Frame>> helpers_;
  std::optional<PoseThreads> threads_;  ///< of these
  std::size_t shared_ = 0;              ///< pieces of all work so far
  std::shared_ptr<const QuestionTables> tables_;
  std::vector<std::unique_ptr<Questions>> questions_;  ///< of this thread and the helpers
};

}  // namespace

std::unique_ptr<CollisionBackend> make_native_backend(std::shared_ptr<DiskCache> cache) {
  return std::make_unique<NativeBackend>(std::move(cache));
}

}  // namespace palpate

#include "cpu_ref/ref_backend.h"

#include <chrono>
#include <exception>
#include <optional>
#include <thread>

#include "cpu_ref/areas.h"
#include "cpu_ref/clearance.h"
#include "cpu_ref/direction.h"
#include "cpu_ref/field.h"
#include "cpu_ref/frame.h"
#include "cpu_ref/heights.h"
#include "cpu_ref/sets.h"
#include "model/contact/contact_areas.h"
#include "model/pose_threads.h"
#include "model/processors.h"

namespace palpate {
namespace {

using namespace cpu_ref;

/// Times one stage after the other.
class StageClock {
 public:
  explicit StageClock(Contacts& out) : out_(out) {}
  void done(const char* stage) {
    const Clock::time_point now = Clock::now();
    out_.times.push_back({stage, std::chrono::duration<double, std::micro>(now - begin_).count()});
    begin_ = now;
  }

 private:
  using Clock = std::chrono::steady_clock;
  Contacts& out_;
  Clock::time_point begin_ = Clock::now();
};

/// Tools grow their boundary by this many steps, for the rounding of transformed vertices (METHOD section 2).
constexpr std::int32_t kToolGrow = 3;

/// Answers one pose at a time on a prepared scene. Others may do the same beside it.
class Asked final : public PoseQuery {
 public:
  Asked(const Prepared& scene, const Plan& plan)
      : scene_(scene),
        plan_(plan),
        open_mockup_(scene.geometry->mockup, scene.mockup_tree, scene.mockup),
        open_tool_(scene.geometry->tool, scene.tool_rest_tree, scene.tool) {}

  Result<void> query(const LatticePose& pose, const Ignored* ignored, Contacts& out) override {
    out = Contacts();
    out.engine = "ref";
    pairs_.clear();
    try {
      if (!pose.beyond_lattice) answer(pose, ignored, out);
      leave_out(out);
      return {};
    } catch (const std::exception& failure) {
      out = Contacts();
      return Error{ErrorCode::kInternal, std::string("The CPU reference failed: ") + failure.what()};
    }
  }

  /// `collinear`: as smallest_distance() has it.
  Result<void> clearance(const LatticePose& pose, std::int32_t within, bool collinear, Clearance& out) {
    out = {};
    Contacts contacts;
    if (auto answered = query(pose, nullptr, contacts); !answered) return answered;
    if (contacts.contact) {
      out.kind = Clearance::Kind::kTouching;
      return {};
    }
    if (pose.beyond_lattice && pose.translation == Int3(0)) return {};
    try {
      Frame frame{scene_, pose, nullptr, tool_tree_, open_mockup_, open_tool_, {}, {},
                  {},     {},   {},      {},         {},           {},         {}};
      tool_tree_.build(transform_tool(frame));
      out = smallest_distance(frame, within, collinear);
      return {};
    } catch (const std::exception& failure) {
      return Error{ErrorCode::kInternal, std::string("The CPU reference failed: ") + failure.what()};
    }
  }

  const std::vector<std::pair<std::uint32_t, std::uint32_t>>& pairs() const { return pairs_; }
  std::uint64_t memory_bytes() const {
    return tool_tree_.memory_bytes() + open_mockup_.memory_bytes() + open_tool_.memory_bytes() +
           sizeof pairs_[0] * std::uint64_t{pairs_.capacity()};
  }

 private:
  void answer(const LatticePose& pose, const Ignored* ignored, Contacts& out) {
    StageClock clock(out);
    Frame frame{scene_, pose, ignored, tool_tree_, open_mockup_, open_tool_, {}, {},
                {},     {},   {},      {},         {},           {},         {}};
    tool_tree_.build(transform_tool(frame));
    clock.done("transform");
    find_pairs(frame, out);
    pairs_ = frame.pairs;
    clock.done("pairs");
    find_voxel_sets(frame, out);
    clock.done("voxels");
    find_samples(frame, out);
    clock.done("est");
    if (scene_.tool_open()) out.flags |= kFlagToolOpen;
    if (!out.contact) return;
    if (scene_.refined()) {
      sum_field(frame, out);
      clock.done("field");
      if (plan_.telemetry) gather_areas(*scene_.geometry, pose, out);
      clock.done("areas");
      return;
    }

    std::vector<Area> areas = find_areas(frame);
    clock.done("areas");
    if (areas.size() > kMaxAreas) {
      out.truncated = true;
      out.truncated_capacity = "areas";
      return;
    }
    for (Area& area : areas) find_direction(frame, area);
    clock.done("direction");
    for (Area& area : areas) {
      measure_heights(frame, area);
      sum_voxels(frame, area);
    }
    clock.done("rays");
    for (Area& area : areas) out.areas.push_back(std::move(area.out));
  }

  /// Everything is worked out here, so that nothing that a plan changes can change the rest; what nobody asks
  /// for is then taken away.
  void leave_out(Contacts& out) const {
    out.contact_points = plan_.contact_point;
    out.lists = plan_.telemetry;
    if (!out.lists) out.carriers.clear();
    if (!out.lists)
      for (auto* ids : {&out.cst, &out.bst, &out.est, &out.cmt, &out.bmt, &out.imt}) ids->clear();
    for (ContactArea& area : out.areas) {
      if (!out.lists) {
        area.zones.clear();
        area.mobile_ids.clear();
      }
      if (out.contact_points) continue;
      area.voxel_sum = {};
      area.voxel_count = 0;
    }
  }

  const Prepared& scene_;
  const Plan& plan_;
  BoxTree tool_tree_;
  OpenBody open_mockup_, open_tool_;
  std::vector<std::pair<std::uint32_t, std::uint32_t>> pairs_;  ///< of the last query
};

class RefBackend final : public CollisionBackend {
 public:
  Result<void> prepare(const SceneGeometry& geometry, const Plan& plan, const Progress& progress) override {
    try {
      auto scene = std::make_unique<Prepared>();
      scene->geometry = &geometry;
      scene->profile = plan.profile;
      plan_ = plan;
      auto mockup = make_partition(geometry.mockup, geometry.mockup_grid, 0, progress);
      if (!mockup) return mockup.error();
      scene->mockup = std::move(*mockup);
      if (scene->refined()) {
        auto tool = make_partition(geometry.tool, geometry.tool_grid, kToolGrow, progress);
        if (!tool) return tool.error();
        scene->tool = std::move(*tool);
      }
      std::vector<Box> boxes;
      for (std::uint32_t s = 0; s < geometry.mockup.triangles.size(); ++s)
        boxes.push_back(geometry.mockup.collapsed(s) ? Box() : triangle_of(geometry.mockup, s).box());
      scene->mockup_tree.build(std::move(boxes));
      if (scene->refined()) {
        boxes.clear();
        for (std::uint32_t m = 0; m < geometry.tool.triangles.size(); ++m)
          boxes.push_back(geometry.tool.collapsed(m) ? Box() : triangle_of(geometry.tool, m).box());
        scene->tool_rest_tree.build(std::move(boxes));
        scene->mockup_has_inside = geometry.mockup.closed ||
                                   OpenBody(geometry.mockup, scene->mockup_tree, scene->mockup).has_inside();
        scene->tool_has_inside =
            geometry.tool.closed || OpenBody(geometry.tool, scene->tool_rest_tree, scene->tool).has_inside();
      }
      drop_askers();
      scene_ = std::move(scene);
      asked_.emplace(*scene_, plan_);
      return {};
    } catch (const std::exception& failure) {  // out of memory, or Embree
      return Error{ErrorCode::kInternal,
                   std::string("The CPU reference could not prepare the scene: ") + failure.what()};
    }
  }

  Result<void> query(const LatticePose& pose, const Ignored* ignored, Contacts& out) override {
    out = Contacts();
    out.engine = "ref";
    if (!asked_) return Error{ErrorCode::kInternal, "The CPU reference was asked before it was prepared."};
    return asked_->query(pose, ignored, out);
  }

  Result<void> share(std::size_t count, const PoseWork& work) override {
    if (!asked_) return Error{ErrorCode::kInternal, "The CPU reference was asked before it was prepared."};
    shared_ += count;
    if (!threads_ && shared_ >= kWorthThreads) make_helpers();
    if (!threads_ || count < 2) return CollisionBackend::share(count, work);
    return threads_->share(*asked_, count, work);
  }

  Result<void> clearance(const LatticePose& pose, std::int32_t within, Clearance& out) override {
    if (!asked_) return Error{ErrorCode::kInternal, "The CPU reference was asked before it was prepared."};
    return asked_->clearance(pose, within, moving_, out);
  }

  /// What is collinear at this pose is not at the next.
  Result<void> free_time(const LatticePose& pose, ScrewMotion& motion, double time, FreeTime& out) override {
    moving_ = true;
    auto done = CollisionBackend::free_time(pose, motion, time, out);
    moving_ = false;
    return done;
  }

  Result<void> replan(const Plan& plan) override {
    if (!scene_ || plan.profile != scene_->profile)
      return Error{ErrorCode::kInternal, "The CPU reference has not been prepared for this profile."};
    plan_ = plan;
    return {};
  }

  Result<VoxelPartition> partition(bool tool) const override {
    if (!scene_ || (tool && !scene_->refined()))
      return Error{ErrorCode::kInternal, "There is no such partition."};
    return tool ? scene_->tool.dense() : scene_->mockup.dense();
  }

  Result<std::vector<std::pair<std::uint32_t, std::uint32_t>>> pairs() const override {
    if (!asked_)
      return Error{ErrorCode::kInternal, "The CPU reference was asked for pairs before it was prepared."};
    return asked_->pairs();
  }

  bool has_internal_voxels() const override { return scene_ && scene_->mockup.has_internal; }
  std::string name() const override { return "ref"; }
  std::string device() const override { return "CPU reference"; }
  std::uint64_t memory_bytes() const override {
    if (!scene_) return 0;
    std::uint64_t sum = scene_->mockup.memory_bytes() + scene_->tool.memory_bytes() +
                        scene_->mockup_tree.memory_bytes() + scene_->tool_rest_tree.memory_bytes() +
                        asked_->memory_bytes();
    for (const auto& helper : helpers_) sum += helper->memory_bytes();
    return sum;
  }

 private:
  void drop_askers() {
    threads_.reset();
    helpers_.clear();
    asked_.reset();
    shared_ = 0;
  }
  /// Somebody to ask, and a thread, for every other processor.
  void make_helpers() {
    std::vector<PoseQuery*> asked;
    for (unsigned i = 1; i < processors(); ++i)
      asked.push_back(helpers_.emplace_back(std::make_unique<Asked>(*scene_, plan_)).get());
    threads_.emplace(std::move(asked));
  }

  Plan plan_;
  std::unique_ptr<Prepared> scene_;
  bool moving_ = false;         ///< clearance() is asked for free_time()
  std::optional<Asked> asked_;  ///< by query()
  std::vector<std::unique_ptr<Asked>> helpers_;
  std::optional<PoseThreads> threads_;  ///< of these
  std::size_t shared_ = 0;              ///< pieces of all work so far
};

}  // namespace

std::unique_ptr<CollisionBackend> make_ref_backend() { return std::make_unique<RefBackend>(); }

}  // namespace palpate

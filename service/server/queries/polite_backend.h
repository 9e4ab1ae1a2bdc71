#pragma once
#include <string>
#include <utility>

#include "model/collision_backend.h"
#include "service/server/queries/turns.h"
#include "service/server/scenes/scene_store.h"

namespace palpate {

/// A scene's engine for work that asks it again and again: each call takes a turn behind the scene's loops,
/// or, beside loops, an engine of its own, where there is room for one. One thread.
class PoliteBackend final : public CollisionBackend {
 public:
  PoliteBackend(SceneStore& store, SceneLease& scene) : store_(store), scene_(scene) {}

  Result<void> prepare(const SceneGeometry&, const Plan&, const Progress&) override {
    return Error{ErrorCode::kInternal, "a scene's engine is prepared already"};
  }
  Result<void> query(const LatticePose& pose, const Ignored* ignored, Contacts& out) override {
    return ask([&](CollisionBackend& by) { return by.query(pose, ignored, out); });
  }
  Result<void> touches(std::span<const LatticePose> poses, std::span<std::uint8_t> bits) override {
    return ask([&](CollisionBackend& by) { return by.touches(poses, bits); });
  }
  Result<void> clearance(const LatticePose& pose, std::int32_t within, Clearance& out) override {
    return ask([&](CollisionBackend& by) { return by.clearance(pose, within, out); });
  }
  Result<void> free_time(const LatticePose& pose, ScrewMotion& motion, double time, FreeTime& out) override {
    return ask([&](CollisionBackend& by) { return by.free_time(pose, motion, time, out); });
  }
  std::string measured_by() const override { return measured_by_; }
  Result<VoxelPartition> partition(bool tool) const override { return scene_->backend->partition(tool); }
  bool has_internal_voxels() const override { return scene_->backend->has_internal_voxels(); }
  std::string name() const override { return scene_->backend->name(); }
  std::string device() const override { return scene_->backend->device(); }
  std::uint64_t memory_bytes() const override { return scene_->backend->memory_bytes(); }

 private:
  template <class Question>
  Result<void> ask(const Question& question) {
    const auto told = [&](CollisionBackend& by) {
      Result<void> done = question(by);
      measured_by_ = by.measured_by();
      return done;
    };
    const Aside aside = scene_.loops() > 0 ? store_.aside(scene_) : Aside{};
    if (aside.backend) return told(*aside.backend);
    const TurnGuard turn(scene_.turns(), TurnGuard::Kind::kBatch);
    return told(*scene_->backend);
  }

  SceneStore& store_;
  SceneLease& scene_;
  std::string measured_by_;
};

}  // namespace palpate

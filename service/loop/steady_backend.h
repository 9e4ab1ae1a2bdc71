#pragma once
#include <functional>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "model/collision_backend.h"
#include "model/shared_backend.h"

namespace palpate {

/// A back end that goes on. Where a list was too small it makes room and asks again; where the first back end
/// fails, a spare one answers from then on; what is more than it can take, a scene or a frame, the spare
/// answers alone. All back ends give the same integers, so no answer tells who gave it; take_notes() does. A
/// query that enlarges or prepares the spare takes as long as it takes: in real time the watchdog holds the
/// force at zero meanwhile.
class SteadyBackend final : public CollisionBackend, public SharedBackend {
 public:
  /// Makes the spare, when it is first needed.
  using Make = std::function<std::unique_ptr<CollisionBackend>()>;

  /// `make_spare` may be empty: then what the first back end can't do remains an error, or a truncated frame.
  SteadyBackend(std::unique_ptr<CollisionBackend> first, Make make_spare);

  /// The first back end, or, if that fails, the spare. Keeps `plan` for a spare that is needed later.
  Result<void> prepare(const SceneGeometry& geometry, const Plan& plan, const Progress& progress) override;
  /// A first back end that can't is a failed one.
  Result<void> finish_preparing() override;
  /// Of the first back end; a spare that has been prepared follows at once, one that will be is prepared for
  /// it.
  Result<void> replan(const Plan& plan) override;
  std::uint64_t preparation_bytes(const SceneGeometry& geometry, const Plan& plan) const override {
    return first_ ? first_->preparation_bytes(geometry, plan) : 0;
  }
  Result<void> query(const LatticePose& pose, const Ignored* ignored, Contacts& out) override;
  Result<void> share(std::size_t count, const PoseWork& work) override;
  std::size_t poses_together(std::size_t count) override;
  bool time_stages(bool wanted) override { return first_ready_ && first_->time_stages(wanted); }
  Result<void> query_batch(std::span<const LatticePose> poses, std::span<Contacts> out) override;
  // Of the first back end; what it doesn't answer the spare does.
  Result<void> touches(std::span<const LatticePose> poses, std::span<std::uint8_t> bits) override;
  Result<void> clearance(const LatticePose& pose, std::int32_t within, Clearance& out) override;
  Result<void> free_time(const LatticePose& pose, ScrewMotion& motion, double time, FreeTime& out) override;

  /// Of the first back end: its fellows have no spare. Not while a query runs.
  Another another() const override {
    const auto* shared = dynamic_cast<const SharedBackend*>(first_.get());
    return shared && first_ready_ ? shared->another() : Another{};
  }

  Result<VoxelPartition> partition(bool tool) const override { return now().partition(tool); }
  Result<std::vector<std::pair<std::uint32_t, std::uint32_t>>> pairs() const override {
    return by_spare_ ? spare_->pairs() : now().pairs();
  }
  bool has_internal_voxels() const override { return now().has_internal_voxels(); }
  std::string measured_by() const override { return measured_by_.empty() ? name() : measured_by_; }
  std::string name() const override { return now().name(); }  ///< of the one that answers now
  std::string device() const override { return now().device(); }
  std::uint64_t memory_bytes() const override;
  std::vector<StageMemory> memory_by_stage() const override { return now().memory_by_stage(); }
  DeviceWork device_work() const override { return now().device_work(); }
  std::vector<std::string> take_notes() override;

 private:
  const CollisionBackend& now() const { return first_ready_ || !spare_ ? *first_ : *spare_; }
  Result<void> ask_first(const LatticePose& pose, const Ignored* ignored, Contacts& out);
  Result<void> prepare_spare(const Progress& progress);
  template <class Ask>
  Result<void> ask_either(Ask ask);
  void first_failed(const Error& error);
  void note(std::string sentence);  ///< each sentence once

  std::unique_ptr<CollisionBackend> first_, spare_;  ///< first_ is gone once it has failed
  Make make_spare_;
  bool first_ready_ = false;  ///< it has prepared the scene
  bool spare_ready_ = false;
  bool by_spare_ = false;    ///< the last query was answered by the spare
  std::string measured_by_;  ///< who answered the last of the planner's questions
  const SceneGeometry* geometry_ = nullptr;
  Plan plan_;
  std::string full_;  ///< the list that could not be enlarged last
  std::vector<std::string> notes_;
  std::size_t told_ = 0;  ///< notes that take_notes() has given
};

}  // namespace palpate

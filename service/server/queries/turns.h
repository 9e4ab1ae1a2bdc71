#pragma once
#include <condition_variable>
#include <cstdint>
#include <memory>
#include <mutex>
#include <string>
#include <utility>
#include <vector>

#include "model/collision_backend.h"

namespace palpate {

/// Who may ask a back end now: one at a time, loops before batches, loops in the order they came. A pose
/// can't be interrupted, so a loop waits for one pose of a batch at most. A batch that has seen kLoopTurns of
/// loops go by gets one turn, so that it isn't starved by loops that always want more.
class Turns {
 public:
  static constexpr std::uint64_t kLoopTurns =
      4;  ///< chosen: loops keep four fifths of the time, and a batch goes on

  void enter_loop();
  void enter_batch();
  void leave();

 private:
  std::mutex mutex_;
  std::condition_variable loops_, batches_;
  bool busy_ = false;
  int batches_waiting_ = 0;
  std::uint64_t head_ = 0, tail_ = 0;  ///< tickets of loops: next to be served, next to be given
  std::uint64_t passed_ = 0;           ///< loop turns since a batch began to wait, or had its turn
};

/// A loop's or a batch's turn, given back at the end of its scope.
class TurnGuard {
 public:
  enum class Kind : std::uint8_t { kLoop, kBatch };
  TurnGuard(Turns& turns, Kind kind) : turns_(turns) {
    kind == Kind::kLoop ? turns.enter_loop() : turns.enter_batch();
  }
  ~TurnGuard() { turns_.leave(); }
  TurnGuard(const TurnGuard&) = delete;
  TurnGuard& operator=(const TurnGuard&) = delete;

 private:
  Turns& turns_;
};

/// A prepared back end as a loop uses it: each query takes a turn. Refers to both.
class BackendInTurns final : public CollisionBackend {
 public:
  BackendInTurns(CollisionBackend& backend, Turns& turns) : backend_(backend), turns_(turns) {}

  Result<void> prepare(const SceneGeometry&, const Plan&, const Progress&) override {
    return Error{ErrorCode::kInternal, "a back end that is shared is prepared already"};
  }
  Result<void> finish_preparing() override {
    const TurnGuard turn(turns_, TurnGuard::Kind::kLoop);
    return backend_.finish_preparing();
  }
  Result<void> query(const LatticePose& pose, const Ignored* ignored, Contacts& out) override {
    const TurnGuard turn(turns_, TurnGuard::Kind::kLoop);
    return backend_.query(pose, ignored, out);
  }
  Result<void> enlarge() override {
    const TurnGuard turn(turns_, TurnGuard::Kind::kLoop);
    return backend_.enlarge();
  }
  Result<VoxelPartition> partition(bool tool) const override { return backend_.partition(tool); }
  bool has_internal_voxels() const override { return backend_.has_internal_voxels(); }
  std::string name() const override { return backend_.name(); }
  std::string device() const override { return backend_.device(); }
  std::uint64_t memory_bytes() const override { return backend_.memory_bytes(); }
  std::vector<std::string> take_notes() override {
    const TurnGuard turn(turns_, TurnGuard::Kind::kLoop);
    return backend_.take_notes();
  }

 private:
  CollisionBackend& backend_;
  Turns& turns_;
};

}  // namespace palpate

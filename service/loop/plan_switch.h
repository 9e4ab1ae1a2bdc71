#pragma once
#include <atomic>
#include <condition_variable>
#include <cstdint>
#include <memory>
#include <mutex>
#include <optional>
#include <string>
#include <thread>
#include <vector>

#include "model/collision_backend.h"
#include "model/result.h"
#include "model/scene/plan.h"

namespace palpate {

/// What a session goes over to.
struct PlanTarget {
  Plan plan;
  bool torques = true;  ///< the device has torque axes
};

/// Another plan for a session that runs: a viewer has come, the device or the profile is another one. A
/// second back end is prepared for it on a thread of its own while the first goes on answering; then the
/// collision worker goes over between two frames, and the first one is the next's. No loop waits for it, and
/// a preparation that fails changes nothing.
class PlanSwitch {
 public:
  /// `other` has been made, not prepared, and answers as the session's own; both outlive the session.
  /// `geometry` outlives this.
  PlanSwitch(const SceneGeometry& geometry, std::unique_ptr<CollisionBackend> other);
  ~PlanSwitch();  ///< waits for a preparation under way
  PlanSwitch(const PlanSwitch&) = delete;
  PlanSwitch& operator=(const PlanSwitch&) = delete;

  /// Asks for another plan. Of several that have not begun, the last counts. Any thread but the loops';
  /// neither waits nor fails.
  void request(const PlanTarget& target);
  /// Prepares it here and now; for virtual time, where no time passes meanwhile. Not beside request().
  void prepare_now(const PlanTarget& target);

  /// The collision worker's side, between frames: if another plan is ready, `backend` becomes the one
  /// prepared for it, and the one that was answers no more. Null: nothing new. Wait-free.
  const PlanTarget* take(CollisionBackend*& backend) noexcept;

  /// What could not be prepared since the last call, a sentence each. Any thread but the loops'.
  std::vector<std::string> take_notes();

 private:
  enum State : int { kIdle, kPreparing, kReady, kTaking };
  void run();
  void prepare(const PlanTarget& target);

  const SceneGeometry& geometry_;
  std::unique_ptr<CollisionBackend> other_;  ///< owned, whichever of the two it is
  CollisionBackend* spare_;  ///< the one that doesn't answer; belongs to the thread unless kReady
  PlanTarget ready_;         ///< what spare_ is prepared for
  std::atomic<int> state_{kIdle};
  PlanTarget taken_;  ///< the worker's copy
  std::mutex mutex_;
  std::condition_variable wake_;
  std::optional<PlanTarget> wanted_;  ///< under mutex_
  bool stop_ = false;                 ///< under mutex_
  std::vector<std::string> notes_;    ///< under mutex_
  std::thread thread_;
};

}  // namespace palpate

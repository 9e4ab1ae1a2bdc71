#pragma once
#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "model/collision_backend.h"
#include "model/scene/scene_geometry.h"
#include "service/loop/axis_loop.h"
#include "service/loop/collision_frame.h"
#include "service/loop/virtual_coupling.h"
#include "service/queries/lone_query.h"

namespace palpate {

/// Two bodies and a motion of the tool: what `bench stability` asks the real collision query about. Metres,
/// seconds.
struct ContactCase {
  std::string name;
  Mesh mockup, tool;                        ///< the mock-up in the world, the tool in its own frame
  double seconds = 1;                       ///< length of the motion
  std::function<Pose(double time_s)> pose;  ///< of the tool; at 0 for a contact that is only pressed
  Vec3 kick{0, 0, 1}, twist{1, 1, 0};  ///< pressed: the ways that contact holds, along which it is disturbed
};

/// Contacts that a force loop is closed over: flat, sphere, corner, a pad, four pads, one as large as the
/// four, pressed down along −z; a tilted peg in its hole and a press fit off its middle.
std::vector<ContactCase> pressed_contacts();

/// Motions at which the chapter's response jumps: corner slide, edge roll-over, peg in hole, four contacts,
/// pierced plate, seam, two pads becoming one, quick retreat, fast impact, grazing, resting.
std::vector<ContactCase> jumping_motions();

using BackendMaker = std::function<Result<std::unique_ptr<CollisionBackend>>()>;

/// A case's bodies, prepared. Doesn't move.
class PreparedCase {
 public:
  /// Errors: the geometry's or the back end's own.
  static Result<std::unique_ptr<PreparedCase>> make(const ContactCase& what, Profile profile,
                                                    const BackendMaker& backend);

  /// Starts anew with nothing held; `stiffness` K, N/m.
  void begin(double stiffness);
  /// What the control loop would get for this pose of the tool. The first error is kept and returned from
  /// then on.
  Result<void> ask(const Pose& pose, LawResult& out);

  /// What a hand would feel at the pose asked last.
  Result<Felt> feel(const Pose& pose);
  /// The spring of profile `refined`; none in `paper`.
  CouplingSettings spring() const;

  const SceneGeometry& geometry() const { return geometry_; }

 private:
  PreparedCase() = default;
  SceneGeometry geometry_;
  Profile profile_ = Profile::kRefined;
  std::unique_ptr<CollisionBackend> backend_;
  std::unique_ptr<CollisionFrame> frame_;
  std::unique_ptr<LoneQuery> lone_;
  double stiffness_ = 0;
  FrameSlot slot_;
};

/// Steps of the sent force and torque from tick to tick over a motion that no force changes.
struct JumpStatistics {
  double force_step_n = 0, torque_step_nm = 0;  ///< the largest
  double force_jerk = 0, torque_jerk = 0;       ///< rms of the second difference, N and N·m a tick²
  double response_step_n = 0;                   ///< the largest between two results
  double least_push_n = 0;  ///< smallest force along the result's own, while it has contact; < 0: it pulled
};

/// Results `delay` ticks old and apart, a law and, where it goes with it, the case's spring; no device
/// limits.
Result<JumpStatistics> jumps(const ContactCase& what, PreparedCase& prepared, const ForceLawSettings& law,
                             int delay);

}  // namespace palpate

#include "service/bench/stability/stability_contacts.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "model/scene/geometry_build.h"

namespace palpate {

Result<std::unique_ptr<PreparedCase>> PreparedCase::make(const ContactCase& what, Profile profile,
                                                         const BackendMaker& backend) {
  std::unique_ptr<PreparedCase> made(new PreparedCase);
  GeometrySettings settings;
  settings.voxel_size_m = 2e-3;  // the same for all, so that their figures compare
  Result<SceneGeometry> geometry = build_geometry(what.mockup, what.tool, settings);
  if (!geometry) return geometry.error();
  made->geometry_ = std::move(*geometry);
  made->profile_ = profile;
  Result<std::unique_ptr<CollisionBackend>> back = backend();
  if (!back) return back.error();
  made->backend_ = std::move(*back);
  Plan plan;
  plan.profile = profile;
  plan.est = profile == Profile::kRefined;
  if (auto done = made->backend_->prepare(made->geometry_, plan, {}); !done) return done.error();
  made->begin(2000);
  return made;
}

void PreparedCase::begin(double stiffness) {
  frame_ = std::make_unique<CollisionFrame>(geometry_, *backend_, profile_, stiffness, true);
  lone_ = std::make_unique<LoneQuery>(geometry_, stiffness);
  stiffness_ = stiffness;
}

Result<Felt> PreparedCase::feel(const Pose& pose) {
  return lone_->ask(*backend_, nullptr, pose, slot_.response);
}

CouplingSettings PreparedCase::spring() const {
  if (profile_ == Profile::kPaper) return {};
  return {stiffness_, stiffness_ * geometry_.tool_gyration_m * geometry_.tool_gyration_m};
}

Result<void> PreparedCase::ask(const Pose& pose, LawResult& out) {
  slot_.sample.pose = pose;
  return frame_->solve(slot_, out);
}

Result<JumpStatistics> jumps(const ContactCase& what, PreparedCase& prepared, const ForceLawSettings& law,
                             int delay) {
  JumpStatistics out;
  prepared.begin(law.stiffness_n_per_m);
  const CouplingSettings spring = law.kind == LawKind::kCorrected ? prepared.spring() : CouplingSettings{};
  ForceLawSettings settings = law;
  if (spring.on()) settings.change_n_per_s = 0;  // the spring's (ControlTick::couple)
  ForceLawState state(settings);
  VirtualCoupling coupling(spring, law.change_n_per_s);
  const Vec3 gc_tool = prepared.geometry().tool_gc_m;
  LawResult pending, arrived;
  Wrench before, step_before;
  Vec3 told(0);
  double force_sum = 0, torque_sum = 0;
  const int ticks = static_cast<int>(std::lround(what.seconds * 1000));
  for (int i = 0; i < ticks; ++i) {
    Pose pose = what.pose(i * 1e-3);
    if (spring.on()) {
      const LawPose tool =
          coupling.follow(state, {i, pose.position + pose.rotation * gc_tool, pose.rotation});
      pose = {tool.gc - tool.rotation * gc_tool, tool.rotation};
    }
    const LawResult* fresh = nullptr;
    if (i % delay == 0) {
      arrived = pending;
      if (arrived.tick >= 0) {
        fresh = &arrived;
        out.response_step_n = std::max(out.response_step_n, glm::length(arrived.wrench.force - told));
        told = arrived.wrench.force;
      }
      if (auto done = prepared.ask(pose, pending); !done) return done.error();
      pending.tick = i;
    }
    Wrench force = state.step({i, pose.position + pose.rotation * gc_tool, pose.rotation}, fresh);
    if (spring.on()) force = coupling.force(force);
    const Wrench step{force.force - before.force, force.torque - before.torque};
    out.force_step_n = std::max(out.force_step_n, glm::length(step.force));
    out.torque_step_nm = std::max(out.torque_step_nm, glm::length(step.torque));
    const Vec3 bend = step.force - step_before.force, twist = step.torque - step_before.torque;
    force_sum += glm::dot(bend, bend);
    torque_sum += glm::dot(twist, twist);
    if (arrived.contact && glm::length(told) > 0)
      out.least_push_n = std::min(out.least_push_n, glm::dot(force.force, told) / glm::length(told));
    before = force;
    step_before = step;
  }
  out.force_jerk = std::sqrt(force_sum / ticks);
  out.torque_jerk = std::sqrt(torque_sum / ticks);
  return out;
}

}  // namespace palpate

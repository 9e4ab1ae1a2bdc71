#include "service/bench/stability_contacts.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <utility>

#include "model/geometry_build.h"

namespace palpate {

Result<std::unique_ptr<PreparedCase>> PreparedCase::make(const ContactCase& what, Profile profile, const BackendMaker& backend) {
  std::unique_ptr<PreparedCase> made(new PreparedCase);
  GeometrySettings settings;
  settings.voxel_size_m = 2e-3;   // the same for all, so that their figures compare
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
}

Result<void> PreparedCase::ask(const Pose& pose, LawResult& out) {
  slot_.sample.pose = pose;
  return frame_->solve(slot_, out);
}

Result<double> highest_stable_query(const ContactCase& what, PreparedCase& prepared, LawKind law, int delay) {
  constexpr double kStep = 1e-6, kAsked = 1000;   // m, N/m
  const Pose start = what.pose(0);
  const Vec3 gc = start.rotation * prepared.geometry().tool_gc_m;
  std::map<long, LawResult> known;
  Result<void> failed;
  prepared.begin(kAsked);
  const double found = highest_stable(100, 20000, [&](double k) {
    AxisLoop loop;
    loop.axis = Vec3(0, 0, 1);
    loop.at_rest = {start.position + gc, start.rotation};
    loop.delivery.delay = delay;
    loop.law = {.kind = law, .stiffness_n_per_m = k, .transitions = delay, .change_n_per_s = 100};
    loop.encoder_step_m = kStep;
    loop.contact = [&](double x, const Pose& pose, LawResult& out) {
      const auto [at, fresh] = known.try_emplace(std::lround(x / kStep));
      if (fresh)
        if (auto done = prepared.ask({pose.position - gc, pose.rotation}, at->second); !done) failed = done;
      out = at->second;
      out.wrench.force *= k / kAsked;   // all forces are K times a depth
      for (ContactPlane& plane : out.planes) plane.force *= k / kAsked, plane.stiffness *= k / kAsked;
    };
    LawResult rest;
    loop.contact(0, loop.at_rest, rest);
    loop.load_n = -rest.wrench.force.z;
    loop.start_x = 5e-5;
    loop.settle_ticks = 200;
    loop.reach_m = 2e-4;
    return failed && AxisLoop::stable(loop.run(10000), 5e-6);
  });
  if (!failed) return failed.error();
  return found;
}

Result<JumpStatistics> jumps(const ContactCase& what, PreparedCase& prepared, const ForceLawSettings& law, int delay) {
  JumpStatistics out;
  prepared.begin(law.stiffness_n_per_m);
  ForceLawState state(law);
  const Vec3 gc_tool = prepared.geometry().tool_gc_m;
  LawResult pending, arrived;
  Wrench before, step_before;
  Vec3 told(0);
  double force_sum = 0, torque_sum = 0;
  const int ticks = static_cast<int>(std::lround(what.seconds * 1000));
  for (int i = 0; i < ticks; ++i) {
    const Pose pose = what.pose(i * 1e-3);
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
    const Wrench force = state.step({i, pose.position + pose.rotation * gc_tool, pose.rotation}, fresh);
    const Wrench step{force.force - before.force, force.torque - before.torque};
    out.force_step_n = std::max(out.force_step_n, glm::length(step.force));
    out.torque_step_nm = std::max(out.torque_step_nm, glm::length(step.torque));
    const Vec3 bend = step.force - step_before.force, twist = step.torque - step_before.torque;
    force_sum += glm::dot(bend, bend);
    torque_sum += glm::dot(twist, twist);
    if (arrived.contact && glm::length(told) > 0) out.least_push_n = std::min(out.least_push_n, glm::dot(force.force, told) / glm::length(told));
    before = force;
    step_before = step;
  }
  out.force_jerk = std::sqrt(force_sum / ticks);
  out.torque_jerk = std::sqrt(torque_sum / ticks);
  return out;
}

}  // namespace palpate

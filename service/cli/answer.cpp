#include "service/cli/answer.h"

#include <algorithm>
#include <chrono>
#include <vector>

#include "service/queries/lone_query.h"

namespace palpate {

namespace {

using Clock = std::chrono::steady_clock;

double us_since(Clock::time_point start) {
  return std::chrono::duration<double, std::micro>(Clock::now() - start).count();
}

Result<void> evaluate(const LoadedScene& scene, CollisionBackend& backend, const Pose& pose, Answer& out) {
  const Result<LatticePose> lattice = to_lattice(pose, scene.geometry);
  if (!lattice) return lattice.error();
  if (auto done = backend.query(*lattice, nullptr, out.contacts); !done) return done;
  const ResponseSettings& settings = scene.scene.response;
  respond(out.contacts, *lattice, scene.geometry, settings.profile, settings.stiffness_n_per_m, out.response);
  return {};
}

}  // namespace

Result<void> answer_frame(HostedScene& scene, const Pose& pose, Answer& out) {
  const auto start = Clock::now();
  if (auto done = evaluate(scene.loaded, *scene.backend, pose, out); !done) return done;
  out.total_us = us_since(start);
  return {};
}

Result<void> answer_pose(HostedScene& scene, const Pose& pose, Answer& out) {
  return answer_pose(scene.loaded, *scene.backend, pose, out);
}

Result<void> answer_pose(const LoadedScene& scene, CollisionBackend& backend, const Pose& pose, Answer& out) {
  const auto start = Clock::now();
  if (auto done = evaluate(scene, backend, pose, out); !done) return done;
  const ResponseSettings& settings = scene.scene.response;
  if (settings.profile == Profile::kRefined)
    if (auto felt =
            LoneQuery(scene.geometry, settings.stiffness_n_per_m).feel(backend, nullptr, pose, out.response);
        !felt)
      return felt;
  out.total_us = us_since(start);
  return {};
}

Result<void> answer_batch(HostedScene& scene, std::span<const Pose> poses, BatchAnswer& out) {
  return answer_batch(scene.loaded, *scene.backend, poses, out);
}

Result<void> answer_batch(const LoadedScene& scene, CollisionBackend& backend, std::span<const Pose> poses,
                          BatchAnswer& out) {
  const auto start = Clock::now();
  const SceneGeometry& geometry = scene.geometry;
  out.poses.clear();
  for (const Pose& pose : poses) {
    const Result<LatticePose> lattice = to_lattice(pose, geometry);
    if (!lattice) return lattice.error();
    out.poses.push_back(*lattice);
  }
  out.contacts.resize(poses.size());
  out.responses.resize(poses.size());
  if (auto done = backend.query_batch(out.poses, out.contacts); !done) return done;
  // Each pose's balance is found by asking for more poses: side by side, too, and together where that pays.
  const ResponseSettings& settings = scene.scene.response;
  const std::size_t each = backend.poses_together(poses.size());
  const auto respond_to = [&](PoseQuery& asked, std::size_t piece) -> Result<void> {
    const std::size_t first = piece * each, count = std::min(each, poses.size() - first);
    std::vector<ContactResponse*> responses;
    for (std::size_t i = first; i < first + count; ++i) {
      respond(out.contacts[i], out.poses[i], geometry, settings.profile, settings.stiffness_n_per_m,
              out.responses[i]);
      responses.push_back(&out.responses[i]);
    }
    if (settings.profile != Profile::kRefined) return {};
    return LoneQueries(geometry, settings.stiffness_n_per_m)
        .feel(asked, poses.subspan(first, count), responses);
  };
  if (auto done = backend.share((poses.size() + each - 1) / each, respond_to); !done) return done;
  out.total_us = us_since(start);
  return {};
}

}  // namespace palpate

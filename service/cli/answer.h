#pragma once
#include <span>
#include <vector>

#include "model/contact/contacts.h"
#include "model/contact/response.h"
#include "model/lattice/pose.h"
#include "service/cli/scene_host.h"

namespace palpate {

/// What a lone pose got. Reused from pose to pose so that its lists keep their memory.
struct Answer {
  Contacts contacts;
  ContactResponse response;
  double total_us = 0;  ///< wall time from pose in to wrench and id lists out
};

/// What many poses got together.
struct BatchAnswer {
  std::vector<LatticePose> poses;
  std::vector<Contacts> contacts;
  std::vector<ContactResponse> responses;
  double total_us = 0;  ///< wall time of all
};

/// Answers poses side by side where the back end can; each as answer_pose would, but for the times. Errors
/// likewise.
Result<void> answer_batch(HostedScene& scene, std::span<const Pose> poses, BatchAnswer& out);
/// The same by another back end that has the scene prepared.
Result<void> answer_batch(const LoadedScene& scene, CollisionBackend& backend, std::span<const Pose> poses,
                          BatchAnswer& out);

/// One frame, as a session asks it: the field at the pose itself, no balance with a spring. What benches
/// time.
Result<void> answer_frame(HostedScene& scene, const Pose& pose, Answer& out);

/// Answers one pose; a lone query holds nothing from a frame before. Errors: not a pose; the back end failed.
Result<void> answer_pose(HostedScene& scene, const Pose& pose, Answer& out);
/// The same by another back end that has the scene prepared.
Result<void> answer_pose(const LoadedScene& scene, CollisionBackend& backend, const Pose& pose, Answer& out);

}  // namespace palpate

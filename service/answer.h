#pragma once
#include "model/contacts.h"
#include "model/pose.h"
#include "model/response.h"
#include "service/scene_host.h"

namespace palpate {

/// What a lone pose got. Reused from pose to pose so that its lists keep their memory.
struct Answer {
  Contacts contacts;
  ContactResponse response;
  double total_us = 0;   ///< wall time from pose in to wrench and id lists out
};

/// Answers one pose; a lone query holds nothing from a frame before. Errors: not a pose; the back end failed.
Result<void> answer_pose(HostedScene& scene, const Pose& pose, Answer& out);
/// The same by another back end that has the scene prepared.
Result<void> answer_pose(const LoadedScene& scene, CollisionBackend& backend, const Pose& pose, Answer& out);

}  // namespace palpate

#pragma once
#include <optional>
#include <string>
#include <vector>

#include "model/collision_backend.h"
#include "model/scene/scene.h"

namespace palpate {

/// What somebody should know of a scene before it is felt, a sentence each.
struct SceneTalk {
  bool free = false;  ///< nothing touches the tool where it starts
  /// How deep the tool starts, where and between which parts; of a contact without a depth, and in `paper`,
  /// that it touches. Empty when it is free.
  std::vector<std::string> start;
  /// `refined`: whose inside is a vote, and of how many of the triangles that touch there it is in
  /// doubt on which side they are; whose walls are so thin that the device pushes through.
  std::vector<std::string> bodies;
};

/// Asks `backend`, which is prepared for the scene, about a pose, the start where none is given; not while
/// anything else asks it. Error: the back end failed.
Result<SceneTalk> scene_talk(const LoadedScene& scene, CollisionBackend& backend,
                             const std::optional<Pose>& at = std::nullopt);

/// How thick a plate must be to hold against `force_n` on the scene's reference area, m. Pushed right through
/// a wall, a plate of thickness t is pushed back by half of k'·t on each of its places: front and back face
/// differ by t in depth, and the other body's own samples say nothing any more. k' times the reference area
/// is K.
inline double least_wall_m(double stiffness_n_per_m, double force_n) {
  return stiffness_n_per_m > 0 ? 2 * force_n / stiffness_n_per_m : 0;
}

}  // namespace palpate

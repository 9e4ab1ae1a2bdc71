#pragma once
#include <vector>

#include "model/scene/scene.h"

namespace palpate {

/// A point of the hand's path between its given points: linear in position and travel, slerp (the short way)
/// in rotation; the stage is that of the last given point at or before `time_s`. Held before the first and
/// after the last point. `path` is not empty and its times ascend. O(log n), never allocates.
PathPoint path_at(const std::vector<PathPoint>& path, double time_s);

/// The guide's frame at a travel, and how it moves with travel.
struct GuideState {
  Pose frame;       ///< world from tool when the three rotations are 0
  Vec3 tangent{0};  ///< d(frame.position)/d(travel), world, no unit
  Vec3 turning{0};  ///< the frame's rotation per travel, world, rad/m
};

/// Through the guide's points, cubic in travel between them, so that tangent and turning have no jumps (a
/// force resolved along the guide would have them, too); `travel_m` is clamped to the guide. `guide` has at
/// least two points, travel strictly ascending; from rotation to rotation it
/// goes the short way. O(log n), never allocates.
GuideState guide_at(const std::vector<GuidePoint>& guide, double travel_m);

}  // namespace palpate

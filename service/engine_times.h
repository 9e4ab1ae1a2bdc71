#pragma once
#include <string>
#include <vector>

#include "model/collision_backend.h"
#include "model/scene/scene.h"

namespace palpate {

/// A frame of an engine at a few poses near the scene's start.
struct EngineTime {
  std::string engine, device;
  double frame_us = 0;  ///< median over the poses in contact, over all if there is none; of each the least
  std::string missing;  ///< why it could not be measured
};

/// A prepared back end's. Errors: its own; a pose.
Result<EngineTime> time_engine(const LoadedScene& scene, CollisionBackend& backend);

/// An engine that is slower by no more than this is as good as another: what is there stays.
inline constexpr double kAlike = 1.1;  // chosen: above what two measurements of one engine differ by

/// What was measured, and which of both answers the sooner or which one is left: "cpu 310 µs on …; gpu 1,240
/// µs on …; cpu is the quicker by a factor of 4".
std::string engines_text(const std::vector<EngineTime>& engines);

}  // namespace palpate

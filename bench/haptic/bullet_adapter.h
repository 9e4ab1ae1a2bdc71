#pragma once
#include "bench/haptic/penalty.h"

namespace yardstick {

/// Bullet's contact points between two GImpact meshes as springs of K each, summed. `contactPairTest` gives
/// all points of the pair; the manifold that Bullet keeps from frame to frame would hold four, and which four
/// depends on the frames before. Single precision, as Debian builds it; margins are 0.
std::unique_ptr<Adapter> make_bullet();

}  // namespace yardstick

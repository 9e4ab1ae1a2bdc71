#pragma once
#include <vector>

#include "model/lattice/pose.h"

namespace palpate {

/// The centreline of a bent pipe: straights and arcs, with a frame that does not twist about the line
/// (rotation-minimising). A frame's x points along the line.
class Centreline {
 public:
  /// Starts at the world's origin along world x, the frame being the world's.
  Centreline() = default;

  void straight(double length);

  /// An arc of `radius` by `angle` (rad) towards a unit vector `side` of the frame's (y, z) plane.
  void bend(const Vec3& side, double angle, double radius);

  double length() const { return length_; }  ///< m

  /// The frame at `s` m from the start; the line goes on straight beyond both ends.
  Pose frame(double s) const;

  struct Part {
    double start = 0, length = 0;  ///< m
    Pose frame;                    ///< at its start
    Vec3 side{0};                  ///< in that frame, towards the centre of the arc
    double radius = 0;             ///< m; 0: straight
  };
  const std::vector<Part>& parts() const { return parts_; }

 private:
  std::vector<Part> parts_;
  double length_ = 0;
};

}  // namespace palpate

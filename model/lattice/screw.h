#pragma once
#include "model/contact/clearance.h"
#include "model/lattice/pose.h"
#include "model/scene/scene_geometry.h"

namespace palpate {

/// The motion between two poses that a screw makes: it turns about one axis, the short way, and shifts along
/// it, both evenly. Time runs from 0 to 1. Without a turn it is a straight line.
class Screw {
 public:
  /// Of the tool's lattice origin, so that the axis is the tool's own. Both poses are finite, their
  /// quaternions unit.
  Screw(const Pose& from, const Pose& to, const SceneGeometry& geometry);

  /// World from tool at a time; at(0) and at(1) are the ends but for the rounding of doubles.
  Pose at(double time) const;
  /// How it moves at a time, in lattice steps.
  Twist twist(double time) const;
  /// No point of the tool goes further than this, steps.
  double length() const;

 private:
  /// A way across the axis turned about it by an angle.
  Vec3 turned(const Vec3& way, double angle) const;

  Quat start_;
  Vec3 origin_{0};       ///< m: the tool's lattice origin at time 0
  Vec3 tool_centre_{0};  ///< m: that origin in the tool's file
  Vec3 axis_{0, 0, 1};
  double angle_ = 0;           ///< rad
  Vec3 along_{0}, across_{0};  ///< m: the origin's way along the axis, and its chord across it
  double step_m_ = 1, radius_ = 0;
};

}  // namespace palpate

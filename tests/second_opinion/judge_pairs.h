#pragma once
#include <cstddef>
#include <vector>

#include "tests/second_opinion/exported.h"

namespace second_opinion {

/// How two triangles that share a point do so.
enum class Meeting {
  kCross,
  kOverlap,
  kTouch
};  ///< through each other; coplanar with common area; in a point or along an edge

/// Decides with CGAL's exact kernels which pairs of triangles share a point.
class PairJudge {
 public:
  /// A triangle without area is in no pair; `tool` is the tool without rotation: what has no area there never
  /// takes part.
  PairJudge(const std::vector<Triangle>& statics, const std::vector<Triangle>& tool);
  /// All pairs that share a point at a pose, ascending.
  Pairs pairs(const std::vector<Triangle>& moved) const;
  /// How a pair that shares a point does.
  Meeting meeting(const Triangle& s, const Triangle& m) const;

 private:
  std::vector<Triangle> statics_;
  std::vector<bool> static_void_, tool_void_;
};

}  // namespace second_opinion

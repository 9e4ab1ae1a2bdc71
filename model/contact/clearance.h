#pragma once
#include <cstdint>

#include "model/lattice/vector.h"

namespace palpate {

/// What stands for "no triangle".
inline constexpr std::uint32_t kNoTriangle = UINT32_MAX;

/// How far the tool is from the mock-up at a pose (docs/EXACTNESS.md, section 10): integers, the same of
/// every engine.
struct Clearance {
  /// What was found.
  enum class Kind : std::uint8_t {
    kApart,     ///< `steps` and what follows say how far and where
    kTouching,  ///< as `contact` of Contacts: `steps` is 0, there are no witnesses
    kFurther,   ///< than was asked for, or the pose is beyond the lattice: nothing else is known
  };
  Kind kind = Kind::kFurther;
  std::int32_t steps = 0;  ///< floor of the smallest distance
  std::uint32_t static_id =
      kNoTriangle;  ///< of the pairs so near the one with the smallest static, then mobile id
  std::uint32_t mobile_id = kNoTriangle;
  Int3 on_static{0}, on_mobile{0};  ///< world lattice: the nearest points of the two, each rounded to nearest
  bool operator==(const Clearance&) const = default;
};

/// How a tool moves on a screw: about an axis and along it, both at constant speed. World axes.
struct Twist {
  Vec3 axis{0, 0, 1};  ///< unit
  double angle = 0;    ///< rad a unit of time, ≥ 0
  Vec3 velocity{0};    ///< of the tool's lattice origin at the pose, steps a unit of time
  double radius = 0;   ///< no point of the tool is further from its lattice origin, steps
};

/// For how long a tool that moves so meets nothing for certain.
struct FreeTime {
  double time = 0;         ///< units of time; at most what was asked for
  bool blocked = false;    ///< `time` ends because of the pair below, else because no more was asked for
  std::int32_t steps = 0;  ///< how far this pair is apart at the pose, floor, or the next whole number
  std::uint32_t static_id = kNoTriangle, mobile_id = kNoTriangle;
};

/// Steps by which the true clearance on a motion may be smaller than between two poses rounded to the
/// lattice: turned entries, vertices and the translation are off by less than 1.4 steps an axis at either
/// pose, 2.4 in all, and doubles by far less than the rest (derived).
inline constexpr std::int32_t kMotionSlack = 8;

}  // namespace palpate

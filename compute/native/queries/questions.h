#pragma once
#include <cstdint>
#include <vector>

#include "compute/native/frame.h"
#include "compute/native/queries/pair_search.h"
#include "compute/scene/partition_lookup.h"
#include "model/contact/clearance.h"
#include "model/result.h"

namespace palpate::native {

/// What containment is told by, made once a scene.
struct Containment {
  Containment(const SceneGeometry& geometry, const SceneTables& scene);

  PartitionLookup mockup;
  /// Both bodies are closed, so that a body that meets nothing lies wholly on one side of the other. Else
  /// containment is a frame's to say.
  bool told_by_corners;
  bool mockup_has_inside;
  std::vector<std::vector<Int3>>
      tool_parts;  ///< corners of each part of the tool that its corners connect, a few
  std::vector<std::array<std::int32_t, 6>> small_parts;  ///< of the mock-up: SearchTables::parts
  Int3 tool_low, tool_high;                              ///< box of the tool
};

/// Answers the planner's questions (docs/EXACTNESS.md, section 10) a pose at a time. One thread; what it is
/// made of outlives it.
class Questions {
 public:
  /// `frame` answers where the pairs alone don't say.
  Questions(const PairTrees& trees, const Containment& containment, Frame& frame)
      : pairs_(trees), containment_(containment), frame_(frame) {}

  Result<bool> touches(const LatticePose& pose);
  Result<void> clearance(const LatticePose& pose, std::int32_t within, Clearance& out);
  FreeTime free_time(ScrewMotion& motion, double time) { return pairs_.free_time(motion, time); }

 private:
  bool surely_outside(const LatticePose& pose) const;
  Result<bool> by_frame(const LatticePose& pose);

  PairSearch pairs_;
  const Containment& containment_;
  Frame& frame_;
  Contacts contacts_;  ///< of frame_
};

}  // namespace palpate::native

#pragma once
#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <vector>

#include "compute/native/broad_phase/broad_phase.h"
#include "compute/native/broad_phase/candidates.h"
#include "compute/native/broad_phase/posed_tool.h"
#include "compute/native/broad_phase/run_tree.h"
#include "compute/native/frame_helper.h"
#include "compute/native/narrow_phase/contact.h"
#include "compute/scene/scene_tables.h"
#include "model/collision_backend.h"
#include "model/contact/contacts.h"
#include "model/scene/plan.h"
#include "model/scene/scene_geometry.h"

namespace palpate::native {

/// Answers one pose at a time on a prepared scene, in `refined`. One thread and, where share() says so, its
/// helper. query() allocates only when more is near than ever before.
class Frame final : public PoseQuery {
 public:
  /// Geometry, and what `scene` names, outlive this. `open`: what is known of bodies that are not closed.
  /// Allocates.
  Frame(const SceneGeometry& geometry, const SceneTables& scene, const Plan& plan, const OpenBodies& open);
  Frame(const Frame&) = delete;
  Frame& operator=(const Frame&) = delete;

  /// As CollisionBackend::query. Error: the plan leaves out what the pose needs.
  Result<void> query(const LatticePose& pose, const Ignored* ignored, Contacts& out) override;
  /// From the next query on.
  void replan(const Plan& plan) { plan_ = plan; }
  /// Whether parts of a query may run on a second thread of the frame's own; false to begin with.
  void share(bool wanted) { sharing_ = wanted; }
  /// Pairs that intersect at the last query's pose.
  std::span<const gpu::ContactPair> pairs() const;
  /// But for what is the scene's.
  std::uint64_t memory_bytes() const;

 private:
  FrameHelper* helper();
  bool find(Candidates& near);
  bool enlarge(std::uint32_t list);

  const SceneGeometry& geometry_;
  Plan plan_;
  std::vector<std::uint32_t> order_;  ///< ids of the tool's triangles by place
  RunTree runs_;
  PosedTool posed_;
  BroadPhase broad_phase_;
  std::unique_ptr<NarrowPhase> contact_;
  std::unique_ptr<FrameHelper> helper_;  ///< null: not asked for yet (helper_tried_), or there is none
  bool sharing_ = false, helper_tried_ = false;
  bool solved_ = false;      ///< the last query came to the contact
  std::uint32_t flags_ = 0;  ///< of every frame within the lattice
  // Room for what the search finds.
  std::vector<TouchCandidate> touch_;
  std::vector<PairCandidate> candidate_pairs_;
  std::vector<std::uint32_t> swallowed_;
  std::vector<gpu::SampleChunk> chunks_;
  std::vector<gpu::FrameSample> inside_, open_;
};

}  // namespace palpate::native

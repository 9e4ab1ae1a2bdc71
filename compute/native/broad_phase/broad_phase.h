#pragma once
#include <array>
#include <cstdint>
#include <memory>
#include <span>
#include <utility>
#include <vector>

#include "compute/native/broad_phase/candidate_pairs.h"
#include "compute/native/broad_phase/candidate_samples.h"
#include "compute/native/broad_phase/candidates.h"
#include "compute/native/broad_phase/posed_tool.h"
#include "compute/native/broad_phase/run_tree.h"
#include "compute/native/broad_phase/turned_boxes.h"
#include "compute/native/frame_helper.h"
#include "compute/scene/brick_bits.h"
#include "compute/scene/occupied_cubes.h"
#include "compute/scene/scene_tables.h"
#include "model/lattice/lattice.h"
#include "model/result.h"
#include "model/scene/scene_geometry.h"
#include "shaders/shared/frame.h"

namespace palpate {

/// What of tool and mock-up may meet at a pose, from boxes that turn with the tool: on the host, so that a
/// frame which can't touch costs no submission, and one that can begins with what is near. Errs only towards
/// "may meet". One thread and its helper; find() does not block, and allocates only where with a helper the
/// lists are larger than before.
class BroadPhase {
 public:
  /// `runs`: of the tool; they, geometry and scene outlive this. Allocates.
  static BroadPhase make(const SceneGeometry& geometry, const SceneTables& scene, const RunTree& runs);
  /// As CandidateSamples::use().
  void use(std::shared_ptr<const OpenInside> known, const PartitionView& tool) {
    if (has_inside_) samples_.use(std::move(known), tool);
  }
  /// Before find() has a helper: what that one needs for itself. Allocates.
  void share();

  /// Fills the lists: tool triangles with the V_bnd and V_int voxels within kCloseSteps of which they may
  /// come, but for runs of them that lie deep inside, pairs that may come within kCloseSteps, and, if the
  /// bodies may meet, samples that may lie inside the tool. The pose must not be beyond the lattice. `helper`
  /// may be null.
  void find(PosedTool& tool, FrameHelper* helper, Candidates& lists);
  /// Voxels, list entries and samples that the last find() looked at.
  std::uint64_t looks() const { return looks_; }
  std::uint64_t bytes() const;

 private:
  struct Box {
    std::array<double, 3> centre, half;  ///< steps, tool lattice frame; half < 0: empty
  };
  struct Reach {
    std::array<double, 3> low, high;  ///< steps, world; closed
  };
  struct Turn;
  struct Search;

  void make_runs(const LatticeMesh& tool);
  void make_occupancy(const PartitionView& mockup);
  Reach reach(const Turn& turn, const Box& box) const;
  bool meets(const Reach& reach) const;
  bool meets(BrickBits::Range voxels) const;
  void search_all(PosedTool& tool, FrameHelper* helper, Candidates& lists);
  unsigned occupied(const EightRanges& voxels) const;
  bool all_internal(const BrickBits::Range& voxels) const;
  void descend(const Search& search, const RunTree::Group& from, CandidatePairs::Seen& seen,
               Candidates& lists) const;
  void find_beside(const Search& search, const Reach* samples_of, FrameHelper& helper, Candidates& lists);
  bool take_run(const Search& search, std::size_t run, CandidatePairs::Seen& seen, Candidates& lists) const;
  void find_samples(const LatticePose& pose, const Reach& whole, Candidates& lists) const;

  std::span<const std::uint32_t> order_;
  std::size_t statics_ = 0;  ///< triangles of the mock-up
  CandidatePairs pairs_;
  std::array<CandidatePairs::Seen, FrameHelper::kLanes> seen_;  ///< by thread of the frame
  std::uint64_t looks_ = 0;
  std::vector<TouchCandidate> second_touch_;  ///< what the helper finds, as large as the lists
  std::vector<PairCandidate> second_pairs_;
  std::vector<std::uint32_t> second_swallowed_;
  CandidateSamples samples_;
  double inside_margin_ = 0;     ///< steps
  bool has_inside_ = false;      ///< samples are asked whether they lie inside the tool
  bool always_samples_ = false;  ///< the tool has an inside that its surface does not close
  bool met_ = false;             ///< at the last pose that was searched, the bodies might meet
  Box whole_{};
  const RunTree* tree_ = nullptr;
  std::vector<EightTriangles> runs_;
  std::vector<std::uint8_t> stout_;  ///< by run: none of its triangles is collinear at any pose
  std::int32_t tool_radius_ = 0;
  gpu::GridConstants grid_{};
  double per_voxel_ = 0;  ///< voxels a step
  std::vector<BrickBits>
      occupied_;  ///< voxels that are not V_ext, bricks with such a voxel, bricks of bricks …
  OccupiedCubes cubes_;
  std::span<const std::array<std::int32_t, 6>> parts_;  ///< SearchTables::parts
};

}  // namespace palpate

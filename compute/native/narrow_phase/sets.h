#pragma once
#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "compute/native/broad_phase/candidates.h"
#include "compute/native/broad_phase/posed_tool.h"
#include "compute/native/frame_helper.h"
#include "compute/native/narrow_phase/cell_memo.h"
#include "compute/native/narrow_phase/id_marks.h"
#include "compute/native/narrow_phase/inside_search.h"
#include "compute/native/narrow_phase/pair_filter.h"
#include "compute/scene/partition_lookup.h"
#include "compute/scene/scene_tables.h"
#include "model/bytes_of.h"
#include "model/scene/scene_geometry.h"

namespace palpate {

/// What detection finds at a pose: frame_state and the lists that the device would leave.
struct FoundSets {
  gpu::FrameState state{};
  std::vector<gpu::StaticResult> statics;  ///< C_s, ascending by id
  std::vector<gpu::MobileResult> mobiles;  ///< C_m by place: what follows each other lies together
  std::vector<gpu::FrameSample> samples;   ///< that count
  std::vector<gpu::ContactPair> pairs;

  std::uint64_t bytes() const {
    return bytes_of(statics) + bytes_of(mobiles) + bytes_of(samples) + bytes_of(pairs);
  }
};

/// Decides about the lists of what is near what the device engine's shaders decide there (docs/EXACTNESS.md
/// sections 3 and 4): sets, pairs and samples inside the tool in `refined`. The same questions, answered
/// exactly, so the same bits. One thread and its helper; make() keeps references to its arguments; decide()
/// allocates only when a contact is larger than all before.
class ContactSets {
 public:
  /// `order`: ids of the tool's triangles by place. `in_tool` outlives this and answers for a tool that is
  /// not closed. `refined`.
  static ContactSets make(const SceneGeometry& geometry, const SceneTables& scene,
                          std::span<const std::uint32_t> order, InsideSearch& in_tool);

  /// `near`: as the search has found it with the same `tool`. `helper` may be null.
  void decide(const PosedTool& tool, const Candidates& near, FrameHelper* helper, FoundSets& out);

  /// A box of world lattice points, low and high, that holds all that may lie inside the tool.
  std::array<Int3, 2> reach(const LatticePose& pose) const;
  /// Those of some samples that lie inside the tool (section 4), in any order, until the next call. `lane`:
  /// the frame's thread that asks.
  std::span<const gpu::FrameSample> inside_of(const LatticePose& pose,
                                              std::span<const gpu::FrameSample> samples, int lane);
  std::uint64_t bytes() const;

 private:
  void list(FoundSets& out);
  /// A point in a V_bnd voxel of the fine partition, of one open sample or of several that follow each other:
  /// first corners of neighbours.
  struct OpenPoint {
    std::uint32_t first;  ///< of its samples
    Int3 at;              ///< in the tool's lattice
    std::uint32_t voxel;
    std::span<const std::uint32_t> list;  ///< the voxel's
    std::uint32_t sides;  ///< a bit a plane of a listed triangle: the point is on its outer side
    bool in_cell;         ///< it is far enough from all of them
  };
  /// A tool triangle's place, and a mark for it (kMobile…).
  struct TouchingPlace {
    std::uint32_t place, mark;
  };
  /// What one of a frame's threads keeps.
  struct alignas(kOwnLines) Lane {
    PairFilter filter;
    std::vector<PairCandidate> pairs;           ///< of this frame: those that meet
    std::vector<OpenPoint> open;                ///< of the part at hand
    std::vector<Int3> points;                   ///< likewise, in the tool's frame
    std::vector<gpu::FrameSample> inside;       ///< of this frame: those that lie inside
    std::vector<gpu::FrameSample> near;         ///< in V_bnd voxels of the fine partition
    std::vector<TouchingPlace> mobiles;         ///< of this frame: what touches voxels
    std::vector<std::uint32_t> touched_voxels;  ///< of this frame: V_bnd ones
    std::vector<std::uint8_t> touched;          ///< by V_bnd voxel: it is one of these
    void untouch() {
      for (const std::uint32_t voxel : touched_voxels) touched[voxel] = 0;
      touched_voxels.clear();
    }
  };
  void decide_voxels(const PosedTool& tool, std::span<const TouchCandidate> candidates, Lane& lane) const;
  void mark_lists(Lane& lane);
  void decide_pairs(const PosedTool& tool, std::span<const PairCandidate> candidates, Lane& lane) const;
  void find_cells(const LatticePose& pose, std::span<const gpu::FrameSample> samples,
                  std::vector<OpenPoint>& open) const;
  void decide_open(const LatticePose& pose, std::span<const gpu::FrameSample> samples, Lane& lane);
  bool open_inside(const LatticePose& pose, const Int3& point, const OpenPoint& open);
  Int3 tool_point(const LatticePose& pose, const Int3& point) const;
  bool inside(const LatticePose& pose, const Int3& point) const;
  bool off(const Int3& at) const;
  bool walks_out(const LatticePose& pose, const Int3& point) const;
  template <class Take>
  void scan(const gpu::SampleChunk& chunk, Take&& take) const;

  const SceneGeometry* geometry_ = nullptr;
  InsideSearch* in_tool_ = nullptr;
  std::span<const std::uint32_t> order_;
  PartitionLookup mockup_, fine_;
  std::span<const std::uint32_t> fine_exit_;
  std::array<Lane, FrameHelper::kLanes> lanes_;  ///< by thread of the frame
  CellMemo cells_;                               ///< of fine V_bnd voxels: whether they are inside
  IdMarks statics_;                              ///< C_s, with kStatic…; between frames none, as below
  IdMarks mobiles_;                              ///< C_m by place, with kMobile…
};

}  // namespace palpate

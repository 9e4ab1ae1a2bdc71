#pragma once
#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "compute/native/force/depth_search.h"
#include "compute/native/frame_helper.h"
#include "compute/native/narrow_phase/inside_search.h"
#include "compute/native/narrow_phase/sets.h"
#include "compute/scene/triangle_tree.h"
#include "model/bytes_of.h"
#include "model/contact/contacts.h"
#include "model/scene/scene_geometry.h"

namespace palpate {

/// Which bodies have an inside (docs/EXACTNESS.md section 4, "Without inside").
struct HasInside {
  bool mockup = true, tool = true;
};

/// The pressure field at a pose (docs/EXACTNESS.md section 8), on the host. One thread and its helper; make()
/// keeps references to its arguments; sum() allocates only when a contact is larger than all before.
class PressureField {
 public:
  /// `order`: ids of the tool's triangles by place. What the arguments refer to outlives this.
  static PressureField make(const SceneGeometry& geometry, const TriangleTree& mockup,
                            const InsideSearch& in_mockup, const TriangleTree& tool,
                            const InsideSearch& in_tool, std::span<const std::uint32_t> order,
                            const HasInside& has_inside);

  /// What is wanted of a field.
  struct Wanted {
    const Ignored* ignored = nullptr;
    bool carriers = true;
  };
  /// Writes `out`'s field, carriers and ignored_touched whole, and adds flags. `helper` may be null.
  void sum(const LatticePose& pose, ContactSets& sets, const FoundSets& found, const Wanted& wanted,
           FrameHelper* helper, Contacts& out);
  /// Groups of eight boxes or triangles that sums have looked at in all.
  std::uint64_t looks() const;
  std::uint64_t bytes() const;

 private:
  struct Push;
  /// An extra sample of the mock-up that is asked whether it lies in the tool.
  struct AskedExtra {
    std::uint32_t triangle;
    std::uint64_t weight_q30;
  };
  /// What one of a frame's threads needs for itself, and what its samples say.
  struct alignas(kOwnLines) Lane {
    DepthSearch mockup_depth, tool_depth;
    InsideSearch in_mockup;
    std::uint32_t near_tool = DepthSearch::kNobody,
                  near_mockup =
                      DepthSearch::kNobody;  ///< places of the last samples' nearest triangles in their trees
    FieldSums field;
    std::uint32_t flags = 0;
    std::vector<CarrierSums> carriers;    ///< the helper's; the asker's are the frame's
    std::vector<std::uint32_t> touched;   ///< ignored patches, in any order
    std::vector<gpu::FrameSample> asked;  ///< extra samples; for a triangle their place in the next one
    std::vector<AskedExtra> extras;
  };
  /// Grid samples of a tool triangle in the list of all: where they begin, the coarsest first, and how many
  /// of them weigh something in a frame of each level.
  struct OwnSamples {
    std::uint32_t begin = 0;
    std::array<std::uint32_t, kSampleLevels + 1> weigh{};
  };
  /// Where a part of C_m's samples begins: which of C_m, and which of its samples.
  struct ToolPart {
    std::uint32_t mobile, sample;
  };
  /// Extra samples by triangle, of which few have some, and by level, for a part with many small faces has
  /// hundreds of thousands, of which a coarse level takes few.
  class Extras {
   public:
    Extras() = default;
    explicit Extras(const LatticeMesh& mesh);
    bool empty() const { return all_.empty(); }
    /// Calls take(extra) for each of a triangle's that may weigh something between a level and the next.
    template <class Take>
    void for_each(std::uint32_t triangle, std::uint32_t level, Take&& take) const;
    std::uint64_t bytes() const;

   private:
    std::span<const ExtraSample> all_;
    std::vector<std::uint64_t> has_;     ///< a bit a triangle
    std::vector<std::uint32_t> before_;  ///< by word of these: bits in the words before
    struct Level {
      std::vector<std::uint32_t> begin, number;  ///< by bit that is set, and one more; of `all_`
    };
    std::array<Level, kSurfaceLevels + 1> levels_;
  };
  void add_push(const Push& push, Lane& lane) const;
  void add(const Push& push, std::uint32_t static_id, std::uint32_t mobile, CarrierSums* carrier,
           Lane& lane) const;
  void push_from_mockup(const LatticePose& pose, std::uint32_t static_id, const Int3& point,
                        std::uint64_t weight_q30, CarrierSums* carrier, Lane& lane) const;
  void push_from_tool(const LatticePose& pose, std::uint32_t mobile, const Int3& point,
                      std::uint64_t weight_q30, Lane& lane) const;
  void sum_samples(const LatticePose& pose, std::span<const gpu::FrameSample> samples,
                   std::span<CarrierSums> carriers, Lane& lane) const;
  void sum_extras(const LatticePose& pose, ContactSets& sets, std::span<const gpu::StaticResult> statics,
                  std::span<CarrierSums> carriers, int number);
  void divide_tool(std::span<const gpu::MobileResult> mobiles);
  void sum_tool(const LatticePose& pose, std::span<const gpu::MobileResult> mobiles, std::size_t part,
                Lane& lane) const;
  bool is_ignored(std::uint32_t static_id, Lane& lane) const;
  template <class Take>
  void work_out_tool_samples(std::uint32_t mobile, Take&& take) const;
  /// Of one body's samples in a frame: a level, and how far to the next, 1/256.
  struct Level {
    std::uint32_t whole = 0, between = 0;
    bool all() const { return (whole | between) == 0; }
  };
  void list_tool_samples(std::span<const std::uint32_t> order);
  void choose_levels(const FoundSets& found, std::uint32_t coarser);
  static std::uint64_t weight_of(const LatticeMesh& mesh, std::uint32_t triangle, int level,
                                 const Level& taken);
  static std::uint64_t weight_of(const ExtraSample& extra, const Level& taken);

  const SceneGeometry* geometry_ = nullptr;
  const InsideSearch* in_tool_ = nullptr;
  Extras mockup_extras_, tool_extras_;
  HasInside has_inside_;
  int lever_shift_ = 0;
  std::vector<OwnSamples> own_;    ///< by tool triangle; empty: the tool's samples are too many to list
  std::vector<Int3> own_samples_;  ///< of the tool, in its lattice frame; of a triangle the coarsest first
  std::vector<std::uint8_t> own_levels_;         ///< of these
  Level mockup_level_, tool_level_;              ///< of this frame
  const Ignored* ignored_ = nullptr;             ///< of this frame
  std::vector<ToolPart> tool_parts_;             ///< of this frame
  std::vector<std::uint32_t> tool_counts_;       ///< likewise: how many samples are asked, by place in C_m
  std::array<Lane, FrameHelper::kLanes> lanes_;  ///< by thread of the frame
};

}  // namespace palpate

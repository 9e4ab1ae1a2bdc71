#pragma once
#include <array>
#include <cstdint>
#include <span>
#include <utility>
#include <vector>

#include "compute/host_copy.h"
#include "compute/id_marks.h"
#include "compute/posed_tool.h"
#include "compute/prepared_scene.h"
#include "model/contacts.h"
#include "model/lattice.h"
#include "model/scene_geometry.h"
#include "shaders/shared/frame.h"
#include "shaders/shared/frame_response.h"

namespace palpate {

/// What detection leaves of a contact, and where the areas go.
struct ContactLists {
  std::span<const gpu::MobileResult> mobiles;    ///< C_m
  std::span<const gpu::FrameSample> samples;     ///< that count
  std::span<gpu::StaticResult> statics;          ///< C_s by slot; area and zone are written
  std::span<gpu::AreaWork> areas;                ///< kMaxFrameAreas; written
  std::span<gpu::SlotWork> slots;                ///< written, one a slot
  std::span<gpu::AreaMember> members;            ///< room for them; written
  bool numbered = false;                         ///< C_s ascends by id, and HostAreas::marks() has just numbered it
};

/// Areas, zones and n_c of a small contact (docs/EXACTNESS.md sections 5 and 6, `refined`), on the host: a few hundred triangles are
/// sooner joined one after the other than in fifteen dispatches. What is large or rare is left to the device, whose shaders say the same bits.
/// One thread; make() keeps references to its arguments; solve() allocates only when a contact is larger than all before.
class HostAreas {
 public:
  /// `most_statics`: C_s beyond which the device takes over. `zones`: the mock-up has edges that are not smooth.
  static Result<HostAreas> make(VulkanDevice& device, const SceneGeometry& geometry, const PreparedScene& scene, std::size_t most_statics, bool zones);

  struct Answer {
    std::uint32_t areas = 0, members = 0;
  };
  /// False: left to the device. `lists` may then be half written.
  bool solve(PosedTool& tool, const Held* held, const ContactLists& lists, Answer& answer);

  /// After solve(): the number of the area that a triangle of C_s belongs to.
  std::uint32_t area_of(std::uint32_t static_id, const ContactLists& lists) const { return lists.slots[slot(static_id, lists)].area; }
  /// On static ids: where HostSets marks C_s.
  IdMarks& marks() { return marks_; }

  std::size_t most_statics() const { return most_statics_; }

 private:
  std::uint32_t slot_at(std::uint32_t place, const ContactLists& lists) const { return lists.numbered ? place : slot_at_[place]; }
  std::uint32_t slot(std::uint32_t id, const ContactLists& lists) const;
  void number(const ContactLists& lists);
  void join_all(const ContactLists& lists);
  void count_samples(const ContactLists& lists) const;
  bool gather(const ContactLists& lists, Answer& answer) const;
  void match_held(const Held& held, const ContactLists& lists, const Answer& answer);
  bool associate(PosedTool& tool, const ContactLists& lists, Answer& answer);
  void begin_area(gpu::AreaWork& area, const LatticePose& pose, const Held* held) const;
  template <class Take>
  bool for_tool_samples(std::uint32_t mobile, Take&& take) const;
  void list_tool_samples();
  bool count_tool_samples(const LatticePose& pose, std::uint32_t mobile, std::uint32_t& count) const;
  bool sum_tool_normals(const LatticePose& pose, const ContactLists& lists, const Answer& answer) const;
  void direct(gpu::AreaWork& area, const Held* held) const;
  bool occupied(const Int3& p) const;

  const SceneGeometry* geometry_ = nullptr;
  std::size_t most_statics_ = 0;
  gpu::SceneConstants constants_{};
  double per_voxel_ = 0;                        ///< of the mock-up, voxels a step
  HostCopy<std::uint32_t> seam_begin_, seams_, brick_slots_;
  HostCopy<gpu::Brick> bricks_;
  std::vector<std::uint64_t> has_seams_;        ///< a bit a static triangle: few have some
  bool split_ = true;                           ///< false: every edge is smooth, an area is one zone
  bool sheets_ = false;                         ///< the mock-up has some
  IdMarks marks_;                               ///< C_s, whose places by ascending id number the tables below
  std::vector<std::uint32_t> slot_at_;          ///< of each place, where C_s does not ascend
  std::vector<std::uint32_t> zone_, area_;      ///< of each place: the first place of its zone and of its area; meanwhile one on the way there
  std::vector<std::pair<std::uint32_t, std::uint32_t>> edges_;   ///< places that share an edge that is not smooth
  struct Sphere {
    Int3 centre;           ///< doubled
    std::int64_t reach;    ///< its square
  };
  std::vector<Sphere> spheres_;                 ///< by area
  std::vector<std::uint32_t> common_, most_common_;   ///< by area: triangles in common with a held one, and the most so far
  std::vector<std::uint32_t> own_sample_begin_; ///< by tool triangle, and one more; empty: not listed
  std::vector<Int3> own_samples_;               ///< of the tool, in its lattice frame
};

}  // namespace palpate

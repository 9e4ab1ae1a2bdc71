#pragma once
#include <array>
#include <cstdint>
#include <optional>
#include <vector>

#include "compute/native/narrow_phase/pair_filter.h"
#include "compute/native/queries/pair_distance.h"
#include "compute/scene/triangle_tree.h"
#include "model/contact/clearance.h"
#include "model/lattice/lattice.h"
#include "model/scene/scene_geometry.h"

namespace palpate::native {

/// Trees over all triangles of both bodies that did not collapse, sheets too; made once a scene, read by any
/// number of threads. 68 bytes a triangle of the mock-up.
struct PairTrees {
  explicit PairTrees(const SceneGeometry& geometry);

  const SceneGeometry* geometry;
  TriangleTree mockup, tool;
  /// Of the mock-up's runs: eight triangles by coordinate, k of corner c at [3 c + k], and their boxes.
  std::vector<std::array<std::array<std::int32_t, kLanes>, 9>> corners;
  std::vector<TriangleTree::Boxes> boxes;
};

/// Asks about pairs of triangles down both trees at once, boxes first, then eight pairs in double precision;
/// what is left open, integers decide (docs/EXACTNESS.md, sections 9 and 10). One thread; allocates only when
/// more is near than ever before.
class PairSearch {
 public:
  explicit PairSearch(const PairTrees& trees);

  enum class Found : std::uint8_t {
    kMeet,
    kClose,
    kNothing
  };  ///< kClose: no pair meets, but one is within kCloseSteps
  /// Whether any pair meets. The pairs that met last are tried first.
  Found any(const LatticePose& pose);
  /// The smallest distance (section 10): kTouching where a pair meets, whether or not something is contained.
  Clearance nearest(const LatticePose& pose, std::int32_t within);
  /// As CollisionBackend::free_time().
  FreeTime free_time(const LatticePose& pose, const Twist& twist, double longest);

  static constexpr double kCloseSteps = 8;
  std::uint64_t looks() const { return looks_; }  ///< boxes and triangles looked at in all

 private:
  struct Node {
    std::uint32_t level, index;  ///< level 0: a run
  };
  struct Item {
    Node tool, mockup;
    BoxOf tool_box, mockup_box;
    double squared;  ///< gap of the boxes
  };
  /// Corners of eight triangles, steps, by coordinate: k of corner c at [3 c + k].
  using Places = std::array<std::array<double, kLanes>, 9>;
  struct Run {  ///< of the tool, at the pose
    std::array<exact::Corners, kLanes> corners;
    EightDoubles boxes;  ///< of no triangle: nowhere
    Places places{};     ///< of no triangle: another's
    std::uint32_t pose = 0, placed = 0;
  };
  struct Group {  ///< of the tool's boxes, at the pose
    EightDoubles boxes;
    std::uint32_t pose = 0;
  };
  struct Candidate {
    std::uint32_t static_id, mobile_id;
    double least;  ///< its distance is no smaller
  };
  template <class Policy>
  void descend(Policy& policy);
  template <class Policy>
  bool leaf(Policy& policy, const Item& item);
  void begin(const LatticePose& pose);
  const EightDoubles& posed_boxes(std::uint32_t group);
  const Run& posed_run(std::uint32_t run);
  /// Of a run that is posed already. For turned_gap() alone: whoever asks for touch needs none.
  const Places& posed_places(std::uint32_t run);
  double turned_gap(std::uint32_t fixed_run, const Places& places) const;
  exact::Corners mobile(std::uint32_t id) const;
  exact::Corners fixed(std::uint32_t id) const;
  bool meet(std::uint32_t static_id, std::uint32_t mobile_id) const;

  struct Any;
  struct Nearest;
  struct Timed;

  const PairTrees* trees_;
  LatticePose pose_{};
  double rotation_[3][3]{}, size_[3][3]{};
  std::uint32_t now_ = 0;  ///< number of the pose
  std::vector<Run> runs_;
  std::vector<Group> groups_;
  std::vector<Item> open_;
  std::vector<Candidate> candidates_;
  PairFilter filter_;
  BoxOf mockup_root_{}, tool_root_{};                  ///< the tool's in its own frame
  std::array<std::array<std::uint32_t, 2>, 2> met_{};  ///< pairs that met last
  std::size_t met_count_ = 0;
  std::array<std::uint32_t, 2> near_{kNoTriangle, kNoTriangle},
      blocking_{kNoTriangle, kNoTriangle};  ///< of the last answers
  std::uint64_t looks_ = 0;
};

}  // namespace palpate::native

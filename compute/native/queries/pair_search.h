#pragma once
#include <array>
#include <cstdint>
#include <limits>
#include <optional>
#include <vector>

#include "compute/native/narrow_phase/pair_filter.h"
#include "compute/native/queries/pair_distance.h"
#include "compute/native/queries/room_field.h"
#include "compute/native/queries/tool_spheres.h"
#include "compute/scene/triangle_tree.h"
#include "model/contact/clearance.h"
#include "model/contact/screw_motion.h"
#include "model/lattice/lattice.h"
#include "model/scene/scene_geometry.h"

namespace palpate::native {

/// Trees over all triangles of both bodies that did not collapse, sheets too; made once a scene, read by any
/// number of threads. Beside the field 79 bytes a triangle of the mock-up and 38 of the tool.
struct PairTrees {
  explicit PairTrees(const SceneGeometry& geometry);
  /// What making and keeping them takes at most, known before.
  static std::uint64_t most_bytes(const SceneGeometry& geometry);
  std::uint64_t bytes() const {
    return mockup.bytes() + tool.bytes() + spheres.bytes() + field.bytes() +
           sizeof corners[0] * std::uint64_t{corners.size()} + sizeof boxes[0] * std::uint64_t{boxes.size()};
  }

  const SceneGeometry* geometry;
  TriangleTree mockup, tool;
  ToolSpheres spheres;  ///< of `tool`
  RoomField field;      ///< of the mock-up
  /// Of the mock-up's runs: eight triangles by coordinate, k of corner c at [3 c + k], and their boxes.
  std::vector<std::array<std::array<std::int32_t, kLanes>, 9>> corners;
  std::vector<TriangleTree::Boxes> boxes;
};

/// Asks about pairs of triangles: the tool's spheres in the mock-up's field first, then the mock-up's boxes,
/// then eight pairs in double precision; what is left open, integers decide (docs/EXACTNESS.md, sections 9
/// and 10). One thread; allocates only when more is near than ever before.
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
  FreeTime free_time(ScrewMotion& motion, double time);

  static constexpr double kCloseSteps = 8;

 private:
  struct Node {  ///< of the mock-up's tree
    std::uint32_t level, index;
    double squared;     ///< gap of its box
    unsigned runs = 0;  ///< of a lowest node those of its runs that may matter: a bit each
  };
  struct Group {  ///< of the tool's spheres
    std::uint32_t level, number;
  };
  struct Lead {
    double room;              ///< steps that the nearest has, at least
    std::uint32_t run, mask;  ///< of its triangles those that may matter
    std::array<double, kLanes> rooms;
  };
  /// Whether a test, RoomField::all_beyond() or that of whole runs in ask(), has paid so far in a search:
  /// where all is as near, or triangles are large, it never does.
  struct Worth {
    std::uint32_t asked = 0, beyond = 0;
    bool worth_asking() const { return asked < 16 || 4 * beyond >= asked; }  // chosen
    void count(bool is_beyond) {
      ++asked;
      beyond += is_beyond ? 1u : 0u;
    }
  };
  struct Around {                    ///< a sphere that holds a run of the tool at the pose
    std::array<double, 9> centre{};  ///< as of a triangle without a size
    PairLanes point{};               ///< likewise, rounded
    double radius = std::numeric_limits<double>::infinity();  ///< with what both are off by
  };
  struct Mobile {  ///< a triangle of the tool at the pose
    std::uint32_t id;
    bool collinear;
    exact::Corners at;
    BoxOf box;
    std::array<double, 9> corners;  ///< k of corner c at [3 c + k]
  };
  /// Corners of eight triangles: k of corner c at [3 c + k].
  using Lanes = std::array<std::array<std::int32_t, kLanes>, 9>;
  struct Candidate {
    std::uint32_t static_id, mobile_id;
    double least;  ///< its distance is no smaller
  };
  void begin(const LatticePose& pose);
  template <class Policy>
  void search(Policy& policy);
  template <class Policy>
  bool dive(Policy& policy);
  template <class Policy>
  bool gather(Policy& policy);
  template <class Policy>
  bool look_about(const Policy& policy, const BoxOf& box);
  Around around(std::uint32_t run) const;
  template <class Policy>
  unsigned near_runs(const Policy& policy, const BoxOf& box, Around& around, std::uint32_t number);
  template <class Policy>
  bool ask(Policy& policy, const Lead& lead, const BoxOf& box);
  template <class Policy>
  void pose(const Policy& policy, const Lead& lead);
  template <class Policy>
  bool descend(Policy& policy, const Lead& lead);
  template <class Policy>
  static std::uint32_t sorted(const Policy& policy, const BoxOf& box, const TriangleTree::Boxes& boxes,
                              const std::array<double, kLanes>& gaps, std::uint32_t all,
                              std::array<std::uint32_t, kLanes>& order);
  template <class Policy>
  bool group(Policy& policy, const Mobile& m, std::uint32_t number, unsigned runs);
  template <class Policy>
  bool leaf(Policy& policy, const Mobile& m, std::uint32_t run, const BoxOf& run_box);
  exact::Corners mobile(std::uint32_t id) const;
  exact::Corners fixed(std::uint32_t id) const;
  bool meet(std::uint32_t static_id, std::uint32_t mobile_id) const;
  double floor_along(const std::array<double, 3>& way) const;

  struct Any;
  struct Nearest;
  struct Timed;
  struct Placed;
  struct Sphere {  ///< in the tool's frame, steps
    std::array<double, 3> centre;
    double radius;
  };
  struct Followed;
  Sphere sphere(std::uint32_t level, std::uint32_t number) const;
  void follow(Followed& followed, double time) const;
  void push_spheres(Followed& followed, std::uint32_t level, std::uint32_t first, std::uint32_t count,
                    double time) const;
  void go_on(Followed& followed, double time);

  const PairTrees* trees_;
  LatticePose pose_{};
  RoomField::Turn turn_{};
  std::vector<Group> groups_;
  std::vector<Lead> leads_;
  Worth balls_, runs_;
  std::size_t runs_asked_ = 0;  ///< of the tool
  std::vector<Node> open_;
  std::vector<std::uint32_t> about_;    ///< groups of the mock-up's runs near eight runs of the tool
  bool looked_about_ = false;           ///< whether these are all
  std::array<Mobile, kLanes> mobiles_;  ///< of a run
  std::size_t count_ = 0;
  BoxOf run_box_{};  ///< of these
  std::vector<Candidate> candidates_;
  PairFilter filter_;
  std::array<std::array<std::uint32_t, 2>, 2> met_{};  ///< pairs that met last
  std::size_t met_count_ = 0;
  std::array<std::uint32_t, 2> near_{kNoTriangle, kNoTriangle};  ///< of the last answer
};

}  // namespace palpate::native

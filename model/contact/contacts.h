#pragma once
#include <array>
#include <cstdint>
#include <string_view>
#include <vector>

#include "model/contact/field.h"
#include "model/lattice/lattice_mesh.h"
#include "model/lattice/vector.h"

namespace palpate {

inline constexpr std::uint32_t kMaxAreas =
    256;  ///< areas in one frame; more is reported as truncated (chosen)

/// What a frame or an area wants to tell. `flag_names` lists the spellings of the query output in bit order.
enum ContactFlag : std::uint32_t {
  kFlagCancelled = 1u << 0,  ///< `paper`: an area's normals cancelled, so it has no direction
  kFlagSheet =
      1u << 1,  ///< triangles of a sheet took part: they are pushed the way out of the body that they are in
  kFlagToolOpen = 1u << 2,     ///< the tool is open and no inside was found: it pushes as a sheet does
  kFlagNoDirection = 1u << 3,  ///< there is contact and nothing that says which way: no force
  kFlagUnsettled =
      1u << 4,  ///< a lone query found no balance of spring and field: its force is the nearest to one
};
inline constexpr std::array<std::string_view, 5> flag_names = {"cancelled", "sheet", "tool_open",
                                                               "no_direction", "unsettled"};

/// One contact area: integers only. docs/EXACTNESS.md defines each to the bit.
struct ContactArea {
  std::uint32_t id = 0;                           ///< smallest static triangle id of the area
  std::vector<std::vector<std::uint32_t>> zones;  ///< static ids, ascending; zones ordered by first id
  std::vector<std::uint32_t> static_ids;          ///< ascending
  std::vector<std::uint32_t> mobile_ids;          ///< ascending
  std::uint32_t flags = 0;                        ///< ContactFlag bits
  Int3 direction{0};             ///< n_c unnormalised, largest |component| in [2^28, 2^29), or 0
  CarrierSums field;             ///< `refined`: what its triangles carry
  std::uint32_t rays = 0;        ///< `paper`: centroids whose ray met the tool; `refined`: samples inside it
  std::uint32_t max_height = 0;  ///< `paper`: largest H
  std::int64_t height_sum = 0;   ///< `paper`: Σ H
  std::array<std::int64_t, 3> voxel_sum{};  ///< `paper`: Σ centres of the area's V_bnd voxels
  std::uint32_t voxel_count = 0;            ///< `paper`
};

/// What a frame leaves out (`refined`).
struct Ignored {
  /// Contacts of parts that overlap where the tool starts: samples whose static triangle, their own or the
  /// nearest, is of one of these patches (LatticeMesh::patch) don't push. Ascending, each once.
  std::vector<std::uint32_t> patches;
  /// Samples, for a frame that has to be quick: so many 256ths of a level more than the contact's size asks
  /// for (docs/EXACTNESS.md section 8), at most kCoarsest.
  std::uint32_t coarser = 0;

  static constexpr std::uint32_t kCoarsest = 256 * kSampleLevels;
};

/// The exact outcome of one pose: identical on every back end. *Static* is the mock-up, *mobile* the tool;
/// docs/NOTATION.md has the symbols.
struct Contacts {
  const char* engine =
      "";  ///< who answered: the back end's name, "gpu", "cpu" or "ref"; empty: nobody had to be asked
  bool contact = false;
  bool truncated = false;  ///< a capacity was too small; `truncated_capacity` names it; no force
  const char* truncated_capacity = "";
  std::uint64_t pairs = 0;  ///< distinct intersecting (static, mobile) pairs
  /// The six sets: triangle ids, ascending. Static: cst intersect a mobile one, est lie inside the tool
  /// (`refined`), bst lie near. Mobile: cmt intersect a static one, imt lie inside the mock-up, bmt lie near.
  /// Near: in a boundary voxel that a mobile triangle touches.
  std::vector<std::uint32_t> cst, bst, cmt, bmt, imt, est;
  std::vector<ContactArea> areas;  ///< ascending id; empty without contact
  FieldSums field;                 ///< `refined`: what pushes the tool
  std::vector<std::uint32_t>
      ignored_touched;  ///< `refined`: ignored patches in which something would push, ascending
  std::vector<CarrierSums>
      carriers;  ///< `refined`: CST and EST, ascending id; empty where the plan leaves lists out
  std::uint32_t flags = 0;
  bool contact_points = true;  ///< false: the plan leaves them out; `paper`: voxel_sum is 0
  bool lists = true;           ///< false: the plan leaves the six sets, zones and mobile_ids out
  /// How long a stage of the frame took.
  struct StageTime {
    const char* stage;
    double us;
    std::uint64_t looks =
        0;  ///< how many things the stage looked at: boxes, triangles, voxels, samples; 0 where nobody counts
  };
  std::vector<StageTime>
      times;  ///< wall or device time by stage, and its work; the only fields that may differ
};

}  // namespace palpate

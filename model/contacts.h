#pragma once
#include <array>
#include <cstdint>
#include <string_view>
#include <vector>

#include "model/vector.h"

namespace palpate {

inline constexpr std::uint32_t kMaxAreas = 256;   ///< areas in one frame; more is reported as truncated (chosen)

/// What a frame or an area wants to tell. `flag_names` lists the spellings of the query output in bit order.
enum ContactFlag : std::uint32_t {
  kFlagNeedle = 1u << 0,        ///< CST but no sample inside: depth from segment mid-points and tool vertices
  kFlagSwallowed = 1u << 1,     ///< the tool is wholly inside: V_int touched, no crossing and no sample inside
  kFlagPierced = 1u << 2,       ///< one of several areas of one pierced plate; only one of them gives force
  kFlagCancelled = 1u << 3,     ///< normals of the primary rule cancelled; another rule gave n_c
  kFlagHeld = 1u << 4,          ///< n_c (or a sheet's side) held from the frame before
  kFlagNearestExternal = 1u << 5,  ///< n_c points to the nearest V_ext voxel
  kFlagSheet = 1u << 6,         ///< the area has triangles of a sheet
  kFlagToolOpen = 1u << 7,      ///< the tool is open and has no inside: heights are the nearest hits
  kFlagNoDirection = 1u << 8,   ///< no rule gave a direction: no force
};
inline constexpr std::array<std::string_view, 9> flag_names = {
    "needle", "swallowed", "pierced", "cancelled", "held", "nearest_external", "sheet", "tool_open", "no_direction"};

/// A sum of 64-bit terms kept in two limbs: value = high · 2^32 + low, low ≥ 0.
struct WideSum {
  std::int64_t low = 0;    ///< sum of the terms' low 32 bits
  std::int64_t high = 0;   ///< sum of the terms >> 32 (arithmetic)
};

/// One contact area: integers only. docs/EXACTNESS.md defines each to the bit.
struct ContactArea {
  std::uint32_t id = 0;                             ///< smallest static triangle id of the area
  std::vector<std::vector<std::uint32_t>> zones;    ///< static ids, ascending; zones ordered by first id
  std::vector<std::uint32_t> static_ids;            ///< ascending
  std::vector<std::uint32_t> mobile_ids;            ///< ascending
  std::uint32_t flags = 0;                          ///< ContactFlag bits (pierced is added by respond())
  Int3 direction{0};                                ///< n_c unnormalised, largest |component| in [2^28, 2^29), or 0
  std::uint32_t rays = 0;                           ///< samples that gave a height
  std::uint32_t max_height = 0;                     ///< largest H
  std::int64_t height_sum = 0;                      ///< Σ (H·w >> 30)
  std::int64_t weight_sum = 0;                      ///< Σ w', Q30, over samples that gave a height; w' fades in with H
  std::int64_t faded_sum = 0;                       ///< Σ P, heights that fade in likewise, …
  std::int64_t faded_rest = 0;                      ///< … and its fraction in 2^-20
  std::int64_t weight_slope = 0;                    ///< 2^10 ∂(Σ w')/∂H, as if all samples went deeper together
  std::int64_t height_slope = 0;                    ///< ∂(Σ P)/∂H, likewise
  std::array<WideSum, 3> moment{};                  ///< Σ (H·w >> 30)·s, world lattice
  std::array<std::int64_t, 3> voxel_sum{};          ///< `paper`: Σ centres of the area's V_bnd voxels
  std::uint32_t voxel_count = 0;                    ///< `paper`
  std::vector<std::uint32_t> pierces;               ///< ascending positions in Contacts::areas that its −n_c rays cross first
  std::int8_t sheet_sign = 0;                       ///< −1, +1 for areas with sheet triangles, else 0
};

/// The exact outcome of one pose: identical on every back end.
struct Contacts {
  bool contact = false;
  bool truncated = false;               ///< a capacity was too small; `truncated_capacity` names it; no force
  const char* truncated_capacity = "";
  std::uint64_t pairs = 0;              ///< distinct intersecting (static, mobile) pairs
  std::vector<std::uint32_t> cst, bst, cmt, bmt, imt, est;   ///< ascending
  std::vector<ContactArea> areas;       ///< ascending id; empty without contact
  std::uint32_t flags = 0;
  bool contact_points = true;           ///< false: the plan leaves them out; moments, height_sum and voxel_sum are 0
  bool lists = true;                    ///< false: the plan leaves the six sets, zones and mobile_ids out
  Int3 swallowed_direction{0};          ///< as ContactArea::direction, when flags has kFlagSwallowed
  std::uint32_t swallowed_height = 0;   ///< H along it
  struct StageTime { const char* stage; double us; };
  std::vector<StageTime> times;         ///< wall or device time by stage; the only fields that may differ
};

/// What a frame remembers of the frame before it (docs/EXACTNESS.md, "Held").
struct HeldArea {
  std::vector<std::uint32_t> static_ids;   ///< ascending
  Int3 direction{0};                       ///< as ContactArea::direction, never 0: an area without one is not held
  std::int8_t sheet_sign = 0;
  bool silent = false;                     ///< pierced, and another area gave the force
};
struct Held {
  std::vector<HeldArea> areas;             ///< in the order of their ids
  Int3 last_direction{0};                  ///< of the deepest area, or of the swallowed tool; 0: none
};

}  // namespace palpate

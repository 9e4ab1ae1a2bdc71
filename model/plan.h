#pragma once
#include <cstdint>
#include <string>
#include <vector>

namespace palpate {

enum class Profile : std::uint8_t { kPaper, kRefined };

/// Which stages a scene, tool, device and profile need. Leaving one out never changes what the others answer.
struct Plan {
  Profile profile = Profile::kRefined;
  bool transform_rotates = true;   ///< false: the tool only translates
  bool imt = true;                 ///< mock-up has V_int voxels
  bool est = true;                 ///< refined
  bool zones = true;               ///< some edge is not smooth
  bool contact_point = true;
  bool torque = true;
  bool telemetry = true;
};

/// One line of `palpate plan`.
struct PlanStage {
  std::string stage;       ///< transform, cull, pairs, imt, bmt, bst, est, areas, zones, rays, contact_point, torque, telemetry
  bool kept = true;
  std::string reason;
  std::uint64_t memory_bytes = 0;
};

}  // namespace palpate

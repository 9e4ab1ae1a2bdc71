#pragma once
#include <cstdint>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "model/collision_backend.h"
#include "tests/equivalence/case.h"
#include "tests/equivalence/digest.h"
#include "tests/equivalence/float_opinion.h"

namespace palpate::equivalence {

/// Who answers. The first one's answers are hashed; every answer of the others is compared to the first
/// one's.
using Backends = std::vector<CollisionBackend*>;

struct RunSettings {
  std::uint64_t seed = 1;
  std::uint64_t first = 0;             ///< first pose compared and counted
  std::optional<std::uint64_t> poses;  ///< empty: the case's own number
  bool twice = false;   ///< ask the first back end every pose again and compare the two answers
  bool batch = false;   ///< ask the first back end all poses of a case together, too, again and again until
                        ///< it has helpers, and compare with its single answers
  bool floats = false;  ///< count where single precision would decide otherwise
  int most_differences = 5;  ///< the rest of a case is not looked at
};

enum class Outcome { kEqual, kDiffers, kNotSupported };

/// What came of one case.
struct CaseRun {
  Outcome outcome = Outcome::kEqual;
  std::vector<std::string> findings;  ///< sentences: what differs at which pose, or what is not supported
  CaseHashes hashes;
  std::uint64_t poses = 0, contacts = 0, with_pairs = 0, areas = 0, known = 0;
  FloatOpinion floats;
  double seconds = 0;
  std::uint32_t flags = 0;  ///< every ContactFlag that an area, a frame or a response had
  std::map<std::string, std::uint64_t>
      met;  ///< poses with members in each set, several areas, several zones, piercing
  std::map<std::string, std::vector<double>> stage_us;  ///< of the first back end, frames with contact
};

/// Prepares the case's scene and asks its poses. Never throws; never prints.
CaseRun run_case(const Case& c, const Backends& backends, const RunSettings& settings);

}  // namespace palpate::equivalence

#pragma once
#include <cstdint>
#include <functional>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "model/lattice/lattice.h"
#include "model/result.h"
#include "model/scene/plan.h"
#include "model/scene/scene_geometry.h"
#include "tests/equivalence/random.h"

namespace palpate::equivalence {

/// (static, mobile) triangles that intersect.
using Pairs = std::vector<std::pair<std::uint32_t, std::uint32_t>>;

/// What is known of an answer by how its pose was made, not by asking a back end. Empty: not known.
struct Known {
  std::optional<Pairs> pairs;  ///< all of them, ascending
  std::optional<std::size_t> areas;
  std::optional<bool> contact;
  std::optional<bool> est;  ///< whether EST has a member
};

/// A scene as both back ends get it, and what they are asked.
struct TestScene {
  SceneGeometry geometry;
  /// A pose; writes what is known of its answer.
  std::function<LatticePose(const SceneGeometry&, Random&, Known&)> pose;
  /// Class of the mock-up's voxel whose lower corner this is, from the scene's construction; empty: no such
  /// knowledge.
  std::function<VoxelClass(const Int3& lower)> known_class = {};
};

/// One line of `equivalence --list`: two bodies, how they are made into integers, where the tool is put, and
/// what must hold. Everything that two back ends compute is compared bit for bit; a case needs no tolerance.
struct Case {
  std::string name;
  std::string family;  ///< solids, chapter, touch, topology, rules or fits
  std::string about;   ///< what it meets that others do not, and what is known of it beforehand
  std::function<Result<TestScene>(std::uint64_t seed)> make;  ///< most scenes do not depend on the seed
  Profile profile = Profile::kRefined;
  bool ignoring = false;  ///< every second patch is ignored; poses come in chains of kChain, each a little
                          ///< further than the one before
  bool coarser =
      false;  ///< pose i leaves samples out: by 97 i mod (Ignored::kCoarsest + 1) more than it has to
  bool killer =
      false;  ///< one of the few that together reach every rule, for those who need an answer in seconds
  bool degenerate =
      false;       ///< of a family where points, edges and faces coincide or a surface is not a solid's
  int poses = 24;  ///< how many the stored hashes cover
  std::uint64_t scene_poses = 400;  ///< in a campaign, after how many poses the next seed's scene is made
  double share = 1;  ///< of a campaign's poses, relative to other cases: less where a pose takes long
};

/// The same in profile `paper`.
inline Case paper(Case c) {
  c.name += "_paper";
  c.profile = Profile::kPaper;
  return c;
}

/// The same with ever coarser samples.
inline Case coarser(Case c) {
  c.name += "_coarser";
  c.coarser = true;
  return c;
}

/// The same where all samples count, however large a contact is.
inline Case all_samples(Case c) {
  c.name += "_all_samples";
  c.make = [make = c.make](std::uint64_t seed) {
    auto scene = make(seed);
    if (scene) scene->geometry.contact_samples = 0;
    return scene;
  };
  return c;
}

inline constexpr int kChain = 8;  ///< poses of a chain of an `ignoring` case

/// All cases, in the order of their hashes.
std::vector<Case> all_cases();

// Each family's own, in cases_*.cpp.
std::vector<Case> solid_cases();
std::vector<Case> chapter_cases();
std::vector<Case> touch_cases();
std::vector<Case> topology_cases();
std::vector<Case> rule_cases();
std::vector<Case> limit_cases();  // of family rules, too
std::vector<Case> fit_cases();

}  // namespace palpate::equivalence

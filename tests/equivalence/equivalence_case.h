#pragma once
#include <cstdint>
#include <functional>
#include <random>
#include <string>

#include "model/geometry_build.h"
#include "model/lattice.h"
#include "model/mesh.h"
#include "model/plan.h"

namespace palpate {

/// Two bodies, how they are made into integers, and where the tool is put.
struct EquivalenceCase {
  std::string name;
  std::function<Mesh()> mockup, tool;
  GeometrySettings settings = {};
  Profile profile = Profile::kRefined;
  int poses = 60;                ///< PALPATE_POSES overrides it
  bool held = false;             ///< each frame remembers the one before it; poses then move on by small steps
  std::function<LatticePose(const SceneGeometry&, std::mt19937_64&)> pose = {};
  std::uint64_t seed = 1;        ///< PALPATE_SEED overrides it
};

/// Asks both back ends, the device one with validation, and fails with seed, pose and first difference where they differ in a bit.
/// Also fails when no pose touched: a comparison of nothing.
void expect_equal_answers(const EquivalenceCase& c);

}  // namespace palpate

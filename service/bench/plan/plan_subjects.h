#pragma once
#include <string>
#include <vector>

#include "model/lattice/pose.h"
#include "model/mesh/mesh.h"
#include "model/scene/geometry_build.h"
#include "model/scene/plan.h"

namespace palpate {

/// A scene that lacks something, and poses that touch it in many ways.
struct PlanSubject {
  std::string name;
  std::string about;  ///< a clause: what it lacks
  Mesh mockup, tool;
  GeometrySettings settings;
  Profile profile = Profile::kRefined;
  bool torque_wanted = true, subscribers = true;
  std::vector<Pose> poses;
};

/// Scenes that lack an inside, sharp edges, rotation, torque, watchers, contact …, alone and together, in
/// both profiles; the first lacks nothing.
std::vector<PlanSubject> plan_subjects();

/// Its facts, as a session would have them; V_int voxels are not known yet.
PlanFacts facts_of(const PlanSubject& subject, const SceneGeometry& geometry);

}  // namespace palpate

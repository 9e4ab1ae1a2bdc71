#include "model/scene/plan.h"

#include <algorithm>
#include <utility>

#include "model/scene/scene.h"
#include "model/scene/scene_geometry.h"

namespace palpate {
namespace {

PlanFacts scene_facts(const Scene& scene, const SceneGeometry& geometry) {
  PlanFacts facts;
  facts.profile = scene.response.profile;
  // The lowest bit of a neighbour says that the edge is smooth.
  facts.rough_edges = std::any_of(geometry.mockup.neighbours.begin(), geometry.mockup.neighbours.end(),
                                  [](EdgeNeighbour neighbour) { return (neighbour & 1u) == 0; });
  return facts;
}

}  // namespace

PlanFacts query_facts(const Scene& scene, const SceneGeometry& geometry) {
  PlanFacts facts = scene_facts(scene, geometry);
  facts.subscribers = true;
  return facts;
}

PlanFacts session_facts(const Scene& scene, const SceneGeometry& geometry, bool subscribers) {
  PlanFacts facts = scene_facts(scene, geometry);
  const auto& actuated = scene.device.actuated;
  facts.torque_wanted = actuated[3] || actuated[4] || actuated[5];
  facts.subscribers = subscribers;
  return facts;
}

PlanDecision decide_plan(const PlanFacts& facts) {
  PlanDecision decision;
  Plan& plan = decision.plan;
  const auto line = [&](const char* stage, bool kept, std::string reason) {
    // A stage that the facts could spare but the user keeps says so.
    if (!kept && facts.full) {
      kept = true;
      reason = "kept because the whole plan was asked for; else: " + reason;
    }
    decision.stages.push_back({stage, kept, std::move(reason), 0});
    return kept;
  };
  const bool refined = facts.profile == Profile::kRefined;
  plan.profile = facts.profile;
  plan.spare_absent = !facts.full;

  line("transform", true, "the tool moves");
  line("cull", true, "only the parts of the tool near the mock-up's surface or inside go on");
  line("pairs", true, "the intersecting triangles are the contact");
  if (facts.internal_voxels.value_or(true))
    plan.imt = line(
        "imt", true,
        facts.internal_voxels ? "the mock-up has V_int voxels" : "V_int voxels are known after preparation");
  else
    plan.imt = line("imt", false, "no V_int voxel");
  line("bmt", true, "mobile triangles in V_bnd voxels belong to the contact");
  line("bst", true, "static triangles in touched V_bnd voxels belong to the contact");
  if (refined) {
    plan.est = line("est", true, "profile refined: static triangles with a sample inside the tool");
  } else {
    // Not a saving but the profile's definition: the whole plan has no EST either.
    plan.est = false;
    decision.stages.push_back({"est", false, "profile paper has no EST and no tool partition", 0});
  }
  line("areas", true, "each contact area has its own direction and depth");
  if (facts.rough_edges)
    plan.zones = line("zones", true, "the mock-up has edges sharper than the smooth angle");
  else
    plan.zones = line("zones", false, "every edge of the mock-up is smooth, so an area is one zone");
  line("rays", true, "heights along n_c give the depth");
  if (facts.torque_wanted)
    plan.contact_point = line("contact_point", true, "torque needs the contact point");
  else
    plan.contact_point =
        line("contact_point", false, "the device has no torque axis, and force alone needs no point");
  if (facts.torque_wanted)
    plan.torque = line("torque", true, "torque is asked for");
  else
    plan.torque = line("torque", false, "the device has no torque axis");
  if (facts.subscribers)
    plan.telemetry =
        line("telemetry", true, "somebody reads lists of triangles: a viewer, a recording or a query");
  else
    plan.telemetry = line("telemetry", false, "nobody listens: no lists of triangles are made");
  return decision;
}

Plan whole_plan_without(Profile profile, const std::string& stage) {
  Plan plan;
  plan.profile = profile;
  plan.est = profile == Profile::kRefined;
  if (stage == "imt") plan.imt = false;
  if (stage == "zones") plan.zones = false;
  if (stage == "contact_point") plan.contact_point = plan.torque = false;
  if (stage == "torque") plan.torque = false;
  if (stage == "telemetry") plan.telemetry = false;
  return plan;
}

}  // namespace palpate

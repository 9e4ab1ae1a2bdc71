#pragma once
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

namespace palpate {

/// Which response: the chapter's to the letter, or the pressure field.
enum class Profile : std::uint8_t { kPaper, kRefined };

/// Which stages a scene, tool, device and profile need. Leaving one out never changes what the others answer.
/// As it stands: everything.
struct Plan {
  Profile profile = Profile::kRefined;
  bool imt = true;    ///< mock-up has V_int voxels
  bool est = true;    ///< refined
  bool zones = true;  ///< some edge is not smooth
  bool contact_point = true;
  bool torque = true;
  bool telemetry = true;      ///< somebody reads lists of triangle ids
  bool spare_absent = false;  ///< what preparation finds the scene to lack (V_int voxels) is left out, too

  bool operator==(const Plan&) const = default;
};

/// One line of `palpate plan`.
struct PlanStage {
  std::string stage;  ///< transform, cull, pairs, imt, bmt, bst, est, areas, zones, rays, contact_point,
                      ///< torque, telemetry
  bool kept = true;
  std::string reason;                ///< why it is kept or left out: a clause without a full stop
  std::uint64_t memory_bytes = 0;    ///< what this stage keeps for the prepared scene; 0 when left out
  std::uint64_t saved_bytes = 0;     ///< that leaving it out spares
  std::optional<double> saved_us{};  ///< likewise, of a median frame; empty: not measured
};

struct SceneGeometry;
struct Scene;

/// What a plan is worked out from. Only facts: none is measured, so the plan is the same on every machine.
struct PlanFacts {
  Profile profile = Profile::kRefined;
  bool full = false;          ///< `--plan full`: keep all that the profile defines
  bool rough_edges = true;    ///< some mock-up edge is not smooth
  bool torque_wanted = true;  ///< the device has torque axes, or the answer is a query's
  bool subscribers =
      false;  ///< somebody reads what frames tell beside forces: telemetry, a recording, a query's answer
  std::optional<bool> internal_voxels;  ///< mock-up has V_int voxels; empty before the back end has prepared
};

/// A plan, and why each stage is kept or left out.
struct PlanDecision {
  Plan plan;
  std::vector<PlanStage> stages;  ///< the thirteen stages, in the order of a frame
};

/// Facts of a `query`: it answers any pose, and reports torque and all lists always.
PlanFacts query_facts(const Scene& scene, const SceneGeometry& geometry);

/// Facts of a `run`: what the scene's device can exert and where its path takes the tool. `subscribers`:
/// telemetry has a listener, or frames are recorded.
PlanFacts session_facts(const Scene& scene, const SceneGeometry& geometry, bool subscribers);

/// The plan for these facts, with the reason for every stage. Pure; leaves `memory_bytes` 0.
PlanDecision decide_plan(const PlanFacts& facts);

/// The whole plan of a profile less one stage, by its name in PlanStage; for measuring what the stage costs.
Plan whole_plan_without(Profile profile, const std::string& stage);

}  // namespace palpate

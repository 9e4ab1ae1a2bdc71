// The plan follows from facts: what is left out, and that the whole plan leaves out nothing.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "model/scene/plan.h"
#include "model/scene/scene.h"

namespace palpate {
namespace {

const PlanStage& stage(const PlanDecision& decision, const std::string& name) {
  for (const PlanStage& line : decision.stages)
    if (line.stage == name) return line;
  ADD_FAILURE() << "no stage " << name;
  return decision.stages.front();
}

PlanFacts poor_facts() {
  PlanFacts facts;
  facts.rough_edges = false;
  facts.torque_wanted = false;
  facts.internal_voxels = false;
  return facts;
}

TEST(Plan, NamesTheThirteenStagesInTheOrderOfAFrame) {
  std::vector<std::string> names;
  for (const PlanStage& line : decide_plan({}).stages) names.push_back(line.stage);
  EXPECT_THAT(names, testing::ElementsAre("transform", "cull", "pairs", "imt", "bmt", "bst", "est", "areas",
                                          "zones", "rays", "contact_point", "torque", "telemetry"));
}

TEST(Plan, EveryStageHasAReason) {
  for (const PlanFacts& facts : {PlanFacts{}, poor_facts()})
    for (const PlanStage& line : decide_plan(facts).stages) EXPECT_FALSE(line.reason.empty()) << line.stage;
}

TEST(Plan, WithoutInternalVoxelsThereAreNoInternalTriangles) {
  PlanFacts facts;
  EXPECT_TRUE(decide_plan(facts).plan.imt) << "nothing is known before preparation, so the stage stays";
  facts.internal_voxels = true;
  EXPECT_TRUE(decide_plan(facts).plan.imt);
  facts.internal_voxels = false;
  EXPECT_FALSE(decide_plan(facts).plan.imt);
  EXPECT_EQ(stage(decide_plan(facts), "imt").reason, "no V_int voxel");
}

TEST(Plan, WithoutSharpEdgesThereAreNoZones) {
  PlanFacts facts;
  facts.rough_edges = false;
  EXPECT_FALSE(decide_plan(facts).plan.zones);
}

TEST(Plan, ADeviceWithoutTorqueAxesNeedsNeitherContactPointNorTorque) {
  PlanFacts facts;
  facts.torque_wanted = false;
  EXPECT_FALSE(decide_plan(facts).plan.contact_point);
  EXPECT_FALSE(decide_plan(facts).plan.torque);
}

TEST(Plan, NobodyListeningNeedsNoLists) {
  EXPECT_FALSE(decide_plan({}).plan.telemetry);
  PlanFacts facts;
  facts.subscribers = true;
  EXPECT_TRUE(decide_plan(facts).plan.telemetry);
  EXPECT_TRUE(query_facts({}, {}).subscribers) << "a query's answer names triangles";
}

TEST(Plan, ProfilePaperHasNoEst) {
  PlanFacts facts;
  facts.profile = Profile::kPaper;
  EXPECT_FALSE(decide_plan(facts).plan.est);
  facts.full = true;
  EXPECT_FALSE(decide_plan(facts).plan.est) << "the profile's definition, not a saving";
}

TEST(Plan, TheWholePlanKeepsAllAndSaysWhatItCouldSpare) {
  PlanFacts facts = poor_facts();
  facts.full = true;
  const PlanDecision decision = decide_plan(facts);
  EXPECT_EQ(decision.plan, Plan{});
  EXPECT_FALSE(decision.plan.spare_absent);
  EXPECT_TRUE(decide_plan(poor_facts()).plan.spare_absent);
  for (const PlanStage& line : decision.stages) EXPECT_TRUE(line.kept) << line.stage;
  EXPECT_THAT(stage(decision, "zones").reason, testing::HasSubstr("else"));
}

TEST(Plan, ASessionsFactsComeFromItsDeviceAndPath) {
  Scene scene;
  SceneGeometry geometry;
  geometry.mockup.neighbours = {3, 5, 7};  // lowest bit set: all smooth
  scene.device.actuated = {true, true, true, false, false, false};
  EXPECT_FALSE(session_facts(scene, geometry, false).torque_wanted);
  EXPECT_FALSE(session_facts(scene, geometry, false).rough_edges);
  EXPECT_TRUE(query_facts(scene, geometry).torque_wanted) << "a query always reports torque";
  scene.device.actuated[4] = true;
  EXPECT_TRUE(session_facts(scene, geometry, false).torque_wanted);
  geometry.mockup.neighbours = {3, 4};
  EXPECT_TRUE(session_facts(scene, geometry, false).rough_edges);
}

}  // namespace
}  // namespace palpate

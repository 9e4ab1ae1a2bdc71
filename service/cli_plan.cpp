#include <fmt/format.h>

#include <algorithm>
#include <cstdio>
#include <nlohmann/json.hpp>

#include "service/cli.h"
#include "service/console.h"
#include "service/numbers.h"
#include "service/scene_host.h"

namespace palpate {

Result<void> plan_command(const SceneOptions& options, bool json, const Parts& parts) {
  catch_interrupts();
  Console console;
  // V_int voxels are known only after the partition has been made, so the scene is prepared as for a run.
  Result<std::unique_ptr<HostedScene>> prepared = prepare_scene(options, Purpose::kSession, parts, console);
  if (!prepared) return prepared.error();
  const std::vector<PlanStage>& stages = (*prepared)->plan.stages;

  if (json) {
    nlohmann::ordered_json lines = nlohmann::ordered_json::array();
    for (const PlanStage& stage : stages)
      lines.push_back({{"stage", stage.stage}, {"kept", stage.kept}, {"reason", stage.reason}, {"memory_bytes", stage.memory_bytes}});
    fmt::print("{}\n", nlohmann::ordered_json{{"stages", lines}}.dump());
    return {};
  }
  fmt::print("{:<14} {:<9} {:>10}  {}\n", "stage", "", "memory", "reason");
  for (const PlanStage& stage : stages)
    fmt::print("{:<14} {:<9} {:>10}  {}\n", stage.stage, stage.kept ? "kept" : "left out", bytes_text(stage.memory_bytes), stage.reason);
  std::uint64_t sum = 0;
  for (const PlanStage& stage : stages) sum += stage.memory_bytes;
  fmt::print("{:<14} {:<9} {:>10}  on {}\n", "in all", "", bytes_text(sum), (*prepared)->backend->device());
  return {};
}

}  // namespace palpate

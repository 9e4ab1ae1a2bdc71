#include <fmt/format.h>

#include <algorithm>
#include <cstdio>
#include <nlohmann/json.hpp>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "model/files/path_file.h"
#include "service/bench/plan/plan_trial.h"
#include "service/cli/cli.h"
#include "service/cli/console.h"
#include "service/cli/numbers.h"
#include "service/cli/scene_host.h"
#include "service/engine_times.h"

namespace palpate {
namespace {

constexpr std::size_t kPoses = 16;  // chosen: tells a few per cent, in milliseconds
constexpr std::uint64_t kRounds = 3;

/// What leaving out each stage spares, measured: the whole plan beside the whole plan less that stage, in
/// turns, at poses of the scene's path. A plan's decisions rest on facts alone; this only tells what they are
/// worth here.
Result<void> measure_savings(HostedScene& hosted, Console& console) {
  const LoadedScene& loaded = hosted.loaded;
  PlanQuestion question{&loaded.geometry, {}, loaded.scene.response.stiffness_n_per_m};
  const auto& path = loaded.scene.device.path;
  for (std::size_t i = 0; i < std::min(kPoses, path.size()); ++i)
    question.poses.push_back(
        path_pose(path[i * path.size() / std::min(kPoses, path.size())], loaded.scene.device.guide));
  if (path.empty()) question.poses.push_back(loaded.scene.start);
  const Plan whole = whole_plan_without(hosted.plan.plan.profile, {});
  for (PlanStage& stage : hosted.plan.stages) {
    const Plan less = whole_plan_without(hosted.plan.plan.profile, stage.stage);
    if (less == whole || stage.kept) continue;
    console.step(("measuring " + stage.stage).c_str());
    PlanTrial with, without;
    for (std::uint64_t round = 0; round < kRounds; ++round)
      for (const auto& [plan, trial] : {std::pair{&whole, &with}, std::pair{&less, &without}}) {
        if (!console.progress("poses", static_cast<double>(round) / static_cast<double>(kRounds)))
          return Error{ErrorCode::kInternal, "interrupted"};
        if (auto done = try_plan(*hosted.backend, question, *plan, 1, *trial); !done) return done;
      }
    stage.saved_us = median_frame_us(with) - median_frame_us(without);
    stage.saved_bytes = with.memory_bytes - std::min(with.memory_bytes, without.memory_bytes);
  }
  return hosted.backend->replan(hosted.plan.plan);
}

/// Both engines that answer a loop, each prepared for the scene anew. Error: interrupted.
Result<std::vector<EngineTime>> measure_engines(const HostedScene& hosted, const Parts& parts,
                                                Console& console) {
  const LoadedScene& loaded = hosted.loaded;
  std::vector<EngineTime> out;
  for (const char* name : {"cpu", "gpu"}) {
    console.step((std::string("measuring the engine ") + name).c_str());
    EngineTime& time = out.emplace_back();
    time.engine = name;
    if (std::string_view(name) == "cpu" && hosted.plan.plan.profile != Profile::kRefined) {
      time.missing = "answers the profile refined alone";
      continue;
    }
    bool stopped = false;
    const Progress progress = [&](const char* what, double done) {
      return !(stopped = stopped || !console.progress(what, done));
    };
    const Result<void> measured = [&]() -> Result<void> {
      auto backend = choose_backend(name, hosted.plan.plan.profile, parts, [](const std::string&) {});
      if (!backend) return backend.error();
      if (auto prepared = (*backend)->prepare(loaded.geometry, hosted.plan.plan, progress); !prepared)
        return prepared;
      if (auto finished = (*backend)->finish_preparing(); !finished) return finished;
      auto timed = time_engine(loaded, **backend);
      if (!timed) return timed.error();
      time = std::move(*timed);
      return {};
    }();
    if (stopped) return Error{ErrorCode::kInternal, "interrupted"};
    if (!measured) time.missing = measured.error().sentence;
  }
  return out;
}

}  // namespace

Result<void> plan_command(const SceneOptions& options, bool json, const Parts& parts) {
  catch_interrupts();
  Console console;
  // V_int voxels are known only after the partition has been made, so the scene is prepared as for a run.
  Result<std::unique_ptr<HostedScene>> prepared = prepare_scene(options, Purpose::kSession, parts, console);
  if (!prepared) return prepared.error();
  if (auto measured = measure_savings(**prepared, console); !measured) return measured.error();
  const Result<std::vector<EngineTime>> engines = measure_engines(**prepared, parts, console);
  if (!engines) return engines.error();
  console.finish();
  const std::vector<PlanStage>& stages = (*prepared)->plan.stages;

  if (json) {
    nlohmann::ordered_json lines = nlohmann::ordered_json::array();
    for (const PlanStage& stage : stages)
      lines.push_back({{"stage", stage.stage},
                       {"kept", stage.kept},
                       {"reason", stage.reason},
                       {"memory_bytes", stage.memory_bytes},
                       {"saved_bytes", stage.saved_bytes},
                       {"saved_us", stage.saved_us ? nlohmann::ordered_json(*stage.saved_us)
                                                   : nlohmann::ordered_json()}});
    nlohmann::ordered_json measured = nlohmann::ordered_json::array();
    for (const EngineTime& e : *engines)
      measured.push_back(
          {{"engine", e.engine},
           {"device", e.device},
           {"frame_us", e.missing.empty() ? nlohmann::ordered_json(e.frame_us) : nlohmann::ordered_json()},
           {"missing", e.missing}});
    fmt::print("{}\n", nlohmann::ordered_json{{"stages", lines}, {"engines", measured}}.dump());
    return {};
  }
  fmt::print("{:<14} {:<9} {:>10} {:>10} {:>10}  {}\n", "stage", "", "memory", "spared", "a frame", "reason");
  for (const PlanStage& stage : stages)
    fmt::print("{:<14} {:<9} {:>10} {:>10} {:>10}  {}\n", stage.stage, stage.kept ? "kept" : "left out",
               bytes_text(stage.memory_bytes), stage.saved_bytes > 0 ? bytes_text(stage.saved_bytes) : "",
               stage.saved_us ? fmt::format("{:+.1f} µs", -*stage.saved_us) : "", stage.reason);
  std::uint64_t sum = 0;
  for (const PlanStage& stage : stages) sum += stage.memory_bytes;
  fmt::print("{:<14} {:<9} {:>10} {:>10} {:>10}  on {}\n", "in all", "", bytes_text(sum), "", "",
             (*prepared)->backend->device());
  fmt::print("engines: a frame near the start, {}\n", engines_text(*engines));
  return {};
}

}  // namespace palpate

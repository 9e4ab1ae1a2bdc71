// `bench force`: the force on fits, plates, thin and open parts against symmetry and closed forms, and along
// poses before real parts.
#include <fmt/format.h>

#include <algorithm>

#include "service/bench/bench.h"
#include "service/bench/force/force_judge.h"
#include "service/bench/output.h"
#include "service/bench/poses.h"
#include "service/cli/scene_host.h"
#include "service/report/run_summary.h"

namespace palpate {
namespace {

void add_row(BenchTable& table, const std::string& name, const std::string& backend, Profile profile,
             double voxels, const ForceFigures& f) {
  std::string broken;
  for (const std::string& sentence : f.broken) broken += (broken.empty() ? "" : "; ") + sentence;
  table.rows.push_back({name, backend, std::string(profile == Profile::kPaper ? "paper" : "refined"), voxels,
                        std::uint64_t{f.touching}, f.largest_n, f.largest_step, 100 * f.loop_share,
                        100 * f.antisymmetry, 100 * f.largest_loss, std::uint64_t{f.reversals},
                        std::uint64_t{f.made_up}, std::uint64_t{f.unsettled}, cell_of(f.hand_step),
                        f.hand_step ? BenchCell(std::uint64_t{f.hand_reversals}) : BenchCell(std::string()),
                        broken});
}

Chart chart_of(const std::string& name) {
  return {.title = name, .unit = "N", .labels = {}, .series = {}, .x_title = "pose"};
}

void add_line(Chart& chart, const std::string& label, const ForceFigures& figures) {
  Chart::Series line{label, {}, {}};
  for (std::size_t i = 0; i < figures.force_n.size(); ++i) {
    line.x.push_back(static_cast<double>(i));
    line.y.push_back(figures.force_n[i]);
  }
  chart.series.push_back(std::move(line));
}

}  // namespace

Result<void> bench_force(const BenchOptions& options, const Parts& parts) {
  catch_interrupts();
  Console console;
  BenchFacts facts{.command = "force", .device = {}, .more = {}};
  BenchTable table{{"case", "backend", "profile", "voxels", "touching", "largest_n", "largest_step",
                    "loop_percent", "antisymmetry_percent", "loss_percent", "reversals", "no_direction",
                    "unsettled", "hand_step", "hand_reversals", "broken"},
                   {}};
  std::vector<Chart> charts;
  const std::vector<Profile> profiles =
      options.profile ? std::vector{*options.profile} : std::vector{Profile::kRefined, Profile::kPaper};
  std::size_t judged = 0, broken = 0;
  if (options.scenes.empty()) {
    auto backend = bench_backend(options, parts, console, facts);
    if (!backend) return backend.error();
    const std::vector<ForceCaseMaker> cases = force_cases();
    for (std::size_t i = 0; i < cases.size(); ++i) {
      const ForceCase subject = cases[i].make();
      Chart chart = chart_of(subject.name);
      for (const Profile profile : profiles)
        for (const double voxels :
             profile == Profile::kRefined ? std::vector{1.0, 0.5, 2.0} : std::vector{1.0}) {
          const Result<ForceFigures> figures = judge_force(subject, **backend, profile, voxels);
          if (!figures) return Error{figures.error().code, subject.name + ": " + figures.error().sentence};
          add_row(table, subject.name, (*backend)->name(), profile, voxels, *figures);
          add_line(chart,
                   fmt::format("{}{}", profile == Profile::kPaper ? "paper" : "refined",
                               voxels == 1 ? "" : fmt::format(", voxels × {}", voxels)),
                   *figures);
          if (profile == Profile::kRefined) {
            ++judged;
            if (!figures->broken.empty()) ++broken;
          }
        }
      charts.push_back(std::move(chart));
      if (!console.progress("the judge's cases",
                            static_cast<double>(i + 1) / static_cast<double>(cases.size())))
        return Error{ErrorCode::kInternal, "interrupted"};
    }
  }
  for (const std::string& file : options.scenes) {
    auto prepared = prepare_scene(
        {file, options.backends.empty() ? "" : options.backends.front(), options.profile, false},
        Purpose::kQuery, parts, console);
    if (!prepared) return prepared.error();
    HostedScene& scene = **prepared;
    const Result<std::vector<Pose>> poses = bench_poses(options, scene, parts, console);
    if (!poses) return poses.error();
    const ForceCase subject{
        .name = scene_name(file), .mockup = {}, .tool = {}, .path = finer_path(*poses, options.frames)};
    const Profile profile = scene.plan.plan.profile;
    const double stiffness = scene.loaded.scene.response.stiffness_n_per_m;
    Result<ForceFigures> figures =
        judge_path(subject, scene.loaded.geometry, *scene.backend, profile, stiffness,
                   [&](double part) { return console.progress("poses", part); });
    if (!figures) return figures.error();
    if (profile == Profile::kRefined)
      if (auto done = judge_hand(subject, scene.loaded.geometry, *scene.backend, stiffness,
                                 scene.loaded.scene.start_contacts, *figures,
                                 [&](double part) { return console.progress("poses of a hand", part); });
          !done)
        return done.error();
    add_row(table, subject.name, scene.backend->name(), profile, 1, *figures);
    charts.push_back(chart_of(subject.name));
    add_line(charts.back(), profile == Profile::kPaper ? "paper" : "refined", *figures);
    facts.device = device_text(*scene.backend, parts);
    ++judged;
    if (!figures->broken.empty()) ++broken;
  }
  console.finish();
  facts.more.emplace_back(
      "broken", fmt::format("{} of {} paths break a limit or a truth (refined and scenes)", broken, judged));
  return write_bench(options.out, facts, table, charts);
}

}  // namespace palpate

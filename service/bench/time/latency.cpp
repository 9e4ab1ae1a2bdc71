#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "service/bench/bench.h"
#include "service/bench/output.h"
#include "service/bench/poses.h"
#include "service/bench/ready_scene.h"
#include "service/bench/time/times.h"
#include "service/cli/answer.h"
#include "service/cli/numbers.h"
#include "service/report/run_summary.h"

namespace palpate {
namespace {

struct Subject {
  std::unique_ptr<HostedScene> scene;
  TimeTable times;
  std::vector<double> least_us = {};  ///< by pose
  bool apart = false;                 ///< stages are told by frames of their own, which take longer
};

/// Asks all poses once more, for the times of their stages alone.
Result<void> time_stages(const BenchOptions& options, const std::vector<Pose>& poses, Subject& subject) {
  Answer answer;
  subject.scene->backend->time_stages(true);
  for (const Pose& pose : poses) {
    const Stopwatch watch(options.cpu_clock);
    if (auto done = answer_frame(*subject.scene, pose, answer); !done) return done;
    subject.times.add_stages(answer.contacts, watch.us());
  }
  subject.scene->backend->time_stages(false);
  return {};
}

/// Asks the first two once more where the first looks the slower, for a machine has other things to do as
/// well: what stays slower is.
Result<void> ask_again(const BenchOptions& options, const std::vector<Pose>& poses,
                       std::vector<Subject>& subjects) {
  constexpr int kAgain = 20;  // chosen
  Answer answer;
  for (std::size_t k = 1; k < subjects.size(); ++k)
    for (std::size_t i = 0; i < poses.size(); ++i)
      for (int again = 0; again < kAgain && subjects[0].least_us[i] > subjects[k].least_us[i]; ++again)
        for (Subject* subject : {&subjects[0], &subjects[k]}) {
          const Stopwatch watch(options.cpu_clock);
          if (auto done = answer_frame(*subject->scene, poses[i], answer); !done) return done;
          subject->least_us[i] = std::min(subject->least_us[i], watch.us());
        }
  return {};
}

/// How often the first is the slower, and where it comes nearest to that: the least times of each frame.
std::string slower_text(const Subject& first, const Subject& other) {
  std::size_t slower = 0, nearest = 0;
  const auto ratio = [&](std::size_t i) { return first.least_us[i] / other.least_us[i]; };
  for (std::size_t i = 0; i < first.least_us.size(); ++i) {
    slower += ratio(i) > 1 ? 1u : 0u;
    if (ratio(i) > ratio(nearest)) nearest = i;
  }
  return fmt::format("slower on {} of {} frames; most at pose {}, {:.1f} and {:.1f} µs, {:.2f} times as long",
                     slower, first.least_us.size(), nearest, first.least_us[nearest], other.least_us[nearest],
                     ratio(nearest));
}

/// Measures one scene on all back ends, in turns, pose by pose.
Result<std::vector<Subject>> measure(const BenchOptions& options, const std::string& file, const Parts& parts,
                                     Console& console) {
  std::vector<Subject> subjects;
  for (const std::string& backend : asked_backends(options)) {
    auto prepared = ready_scene(options, file, backend, Purpose::kSession, parts, console);
    if (!prepared) return prepared.error();
    const bool apart = (*prepared)->backend->time_stages(false);
    subjects.push_back({std::move(*prepared), {}, {}, apart});
  }
  const Result<std::vector<Pose>> poses = bench_poses(options, *subjects.front().scene, parts, console);
  if (!poses) return poses.error();

  // The first round warms up and is not counted.
  console.step("measuring");
  Answer answer;
  for (std::uint64_t round = 0; round <= options.rounds; ++round)
    for (std::size_t i = 0; i < poses->size(); ++i) {
      for (std::size_t k = 0; k < subjects.size(); ++k) {
        Subject& subject = subjects[(i + k) % subjects.size()];  // nobody is always the first
        const DeviceWork before = subject.scene->backend->device_work();
        const Stopwatch watch(options.cpu_clock);
        if (auto done = answer_frame(*subject.scene, (*poses)[i], answer); !done) return done.error();
        const double total_us = watch.us();
        subject.least_us.resize(poses->size(), HUGE_VAL);
        subject.least_us[i] = std::min(subject.least_us[i], total_us);
        if (round == 0) continue;
        const DeviceWork work = since(before, subject.scene->backend->device_work());
        if (subject.apart)
          subject.times.add(frame_kind(answer.contacts), total_us, work);
        else
          subject.times.add(answer.contacts, total_us, work);
      }
      const double done = static_cast<double>(round * poses->size() + i) /
                          static_cast<double>((options.rounds + 1) * poses->size());
      if (i % 16 == 0 && !console.progress("poses", done)) return Error{ErrorCode::kInternal, "interrupted"};
    }
  for (Subject& subject : subjects)
    for (std::uint64_t round = 0; subject.apart && round < options.rounds; ++round)
      if (auto done = time_stages(options, *poses, subject); !done) return done.error();
  if (auto done = ask_again(options, *poses, subjects); !done) return done.error();
  console.finish();
  return subjects;
}

void add_rows(const std::string& scene, const Subject& subject, BenchTable& table) {
  for (std::size_t kind = 0; kind < 4; ++kind)
    for (const std::string& stage : subject.times.stages()) {
      const TimePercentiles p = percentiles(subject.times.times(kind, stage));
      if (p.count == 0) continue;
      auto& row = table.rows.emplace_back(
          std::vector<BenchCell>{scene, subject.scene->backend->name(), kFrameKindNames[kind], stage,
                                 std::uint64_t{p.count}, p.p50, p.p95, p.p99, cell_of(p.p999), p.max});
      for (BenchCell& cell : work_cells(stage == "total" ? subject.times.work(kind) : DeviceWork{}))
        row.push_back(std::move(cell));
    }
}

}  // namespace

Result<void> bench_latency(const BenchOptions& options, const Parts& parts) {
  catch_interrupts();
  Console console;
  BenchFacts facts{.command = "latency", .device = {}, .more = {}};
  BenchTable table{
      {"scene", "backend", "frames", "stage", "count", "p50_us", "p95_us", "p99_us", "p999_us", "max_us"},
      {}};
  table.columns.insert(table.columns.end(), kWorkColumns.begin(), kWorkColumns.end());
  Chart stages{.title = "Median of each stage, frames in contact",
               .unit = "µs",
               .labels = {},
               .series = {},
               .stacked = true,
               .x_title = {}};
  Chart tails{.title = "Whole frame, all frames",
              .unit = "µs",
              .labels = {"p50", "p95", "p99", "max"},
              .series = {},
              .log_y = true,
              .x_title = {}};
  const double load = load_average();
  for (const std::string& file : options.scenes) {
    const auto subjects = measure(options, file, parts, console);
    if (!subjects) return subjects.error();
    for (std::size_t k = 1; k < subjects->size(); ++k)
      facts.more.emplace_back(
          fmt::format("{}, {} beside {}", scene_name(file), subjects->front().scene->backend->name(),
                      (*subjects)[k].scene->backend->name()),
          slower_text(subjects->front(), (*subjects)[k]));
    for (const Subject& subject : *subjects) {
      const HostedScene& scene = *subject.scene;
      const std::string name = scene_name(file),
                        label = subjects->size() > 1 ? name + ", " + scene.backend->name() : name;
      add_rows(name, subject, table);
      const TimePercentiles all = percentiles(subject.times.times(3, "total"));
      tails.series.push_back({label, {}, {all.p50, all.p95, all.p99, all.max}});
      // One bar a subject, one colour a stage.
      stages.labels.push_back(label);
      for (const std::string& stage : subject.times.stages()) {
        if (stage == "total") continue;
        auto series = std::find_if(stages.series.begin(), stages.series.end(),
                                   [&](const auto& s) { return s.label == stage; });
        if (series == stages.series.end()) series = stages.series.insert(series, {stage, {}, {}});
        series->y.resize(stages.labels.size() - 1);
        series->y.push_back(percentiles(subject.times.times(0, stage)).p50);
      }
      const SceneGeometry& geometry = scene.loaded.geometry;
      facts.more.emplace_back(
          label, fmt::format("mock-up {} triangles, tool {}, read {:.2f} s, prepared {:.2f} s, {} on {}",
                             count_text(geometry.mockup.triangles.size()),
                             count_text(geometry.tool.triangles.size()), scene.load_s, scene.prepare_s,
                             bytes_text(scene.backend->memory_bytes()), scene.backend->name()));
      facts.add_device(device_text(*scene.backend, parts));
    }
  }
  facts.more.emplace_back("clock", options.cpu_clock ? "CPU time of this process" : "wall");
  facts.more.emplace_back("load average",
                          fmt::format("{:.1f} at the start, {:.1f} at the end", load, load_average()));
  return write_bench(options.out, facts, table, {stages, tails});
}

}  // namespace palpate

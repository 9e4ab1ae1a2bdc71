#include <fmt/format.h>

#include <algorithm>

#include "service/bench/bench.h"
#include "service/bench/output.h"
#include "service/bench/poses.h"
#include "service/bench/times.h"
#include "service/cli/answer.h"
#include "service/report/run_summary.h"

namespace palpate {
namespace {

constexpr std::size_t kSizes[] = {1, 4, 16, 64, 256, 1024};

/// Poses of a size, times of a pose in them.
struct Series {
  std::size_t size = 0;
  std::vector<double> pose_us;   ///< a batch each
};

struct Outcome {
  std::vector<Series> batches;
  std::vector<double> single_us, stages_us;   ///< a pose each: whole, and its stages together
};

double sum_of_stages(const Contacts& contacts) {
  double sum = 0;
  for (const auto& time : contacts.times) sum += time.us;
  return sum;
}

double mean(const std::vector<double>& values) {
  double sum = 0;
  for (const double v : values) sum += v;
  return values.empty() ? 0 : sum / static_cast<double>(values.size());
}

/// In turns: single poses, then a batch of each size, again and again; the first round warms up.
Result<Outcome> measure(const BenchOptions& options, HostedScene& scene, const std::vector<Pose>& poses, Console& console) {
  Outcome out;
  for (const std::size_t size : kSizes) out.batches.push_back({size, {}});
  // The same poses for all: as many as the largest batch has, gone through as often as need be.
  std::vector<Pose> all;
  for (std::size_t i = 0; i < kSizes[std::size(kSizes) - 1]; ++i) all.push_back(poses[i % poses.size()]);
  Answer answer;
  BatchAnswer batch;
  console.step("measuring");
  for (std::uint64_t round = 0; round <= options.rounds; ++round) {
    for (const Pose& pose : all) {
      if (auto done = answer_frame(scene, pose, answer); !done) return done.error();
      if (round == 0) continue;
      out.single_us.push_back(answer.total_us);
      out.stages_us.push_back(sum_of_stages(answer.contacts));
    }
    for (Series& series : out.batches) {
      double us = 0;
      for (std::size_t first = 0; first < all.size(); first += series.size) {
        if (auto done = answer_batch(scene, {all.data() + first, series.size}, batch); !done) return done.error();
        us += batch.total_us;
      }
      if (round > 0) series.pose_us.push_back(us / static_cast<double>(all.size()));
      if (!console.progress("poses", static_cast<double>(round) / static_cast<double>(options.rounds + 1))) return Error{ErrorCode::kInternal, "interrupted"};
    }
  }
  console.finish();
  return out;
}

}  // namespace

Result<void> bench_throughput(const BenchOptions& options, const Parts& parts) {
  catch_interrupts();
  Console console;
  BenchFacts facts{.command = "throughput", .device = {}, .more = {}};
  BenchTable table{{"backend", "batch", "poses_per_s", "scene", "pose_us", "share_of_stages", "share_of_single"}, {}};
  BenchChart chart{.title = "Poses a second", .unit = "1/s", .labels = {}, .series = {}, .log_x = true, .x_title = "poses a batch"};
  const double load = load_average();
  for (const std::string& file : options.scenes) {
    auto prepared = prepare_scene({file, options.backends.empty() ? "" : options.backends.front(), options.profile, false}, Purpose::kQuery, parts, console);
    if (!prepared) return prepared.error();
    if (auto done = (*prepared)->backend->finish_preparing(); !done) return done.error();   // no frame beside compilers
    HostedScene& scene = **prepared;
    const Result<std::vector<Pose>> poses = bench_poses(options, scene, parts, console);
    if (!poses) return poses.error();
    const Result<Outcome> outcome = measure(options, scene, *poses, console);
    if (!outcome) return outcome.error();
    const std::string name = scene_name(file), backend = scene.backend->name();
    const double single = mean(outcome->single_us), stages = mean(outcome->stages_us);
    table.rows.push_back({backend, std::string("single"), 1e6 / single, name, single, single / stages, 1.0});
    BenchChart::Series line{name, {}, {}};
    for (const Series& series : outcome->batches) {
      const double us = mean(series.pose_us);
      table.rows.push_back({backend, std::uint64_t{series.size}, 1e6 / us, name, us, us / stages, us / single});
      line.x.push_back(static_cast<double>(series.size));
      line.y.push_back(1e6 / us);
    }
    chart.series.push_back(std::move(line));
    facts.device = device_text(*scene.backend, parts);
    facts.more.emplace_back(name, fmt::format("{} poses, their stages together {:.0f} µs a pose when asked singly", poses->size(), stages));
  }
  facts.more.emplace_back("clock", "wall");
  facts.more.emplace_back("load average", fmt::format("{:.1f} at the start, {:.1f} at the end", load, load_average()));
  return write_bench(options.out, facts, table, {chart});
}

}  // namespace palpate

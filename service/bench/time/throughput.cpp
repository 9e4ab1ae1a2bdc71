#include <fmt/format.h>

#include <algorithm>

#include "service/bench/bench.h"
#include "service/bench/output.h"
#include "service/bench/poses.h"
#include "service/bench/ready_scene.h"
#include "service/bench/time/times.h"
#include "service/cli/answer.h"
#include "service/report/run_summary.h"

namespace palpate {
namespace {

/// What is asked of a pose: whether it touches; the force alone, as loops and planners want it; the lists of
/// triangles and areas, too; and a lone query's balance besides.
enum class Wanted : std::uint8_t { kTouch, kForces, kFrames, kAnswers };
constexpr const char* kWantedNames[] = {"touch", "forces", "frames", "answers"};

/// Poses asked together, and what they took.
struct Series {
  Wanted wanted{};
  std::size_t size = 0;         ///< 0: asked singly
  std::vector<double> pose_us;  ///< a round each: the mean over all poses
  DeviceWork work;              ///< of one batch
};

double mean(const std::vector<double>& values) {
  double sum = 0;
  for (const double v : values) sum += v;
  return values.empty() ? 0 : sum / static_cast<double>(values.size());
}

// Of a round of one series (chosen): small batches take long, and a thousand poses tell their mean.
constexpr std::size_t kLeastPoses = 1024, kBatches = 8;

/// Four times as many each time.
std::vector<std::size_t> batch_sizes(std::size_t largest) {
  std::vector<std::size_t> sizes;
  for (std::size_t size = 1; size < largest; size *= 4) sizes.push_back(size);
  sizes.push_back(largest);
  return sizes;
}

Result<void> ask_touches(HostedScene& scene, std::span<const Pose> poses, BatchAnswer& out) {
  const Stopwatch watch(false);
  out.poses.clear();
  for (const Pose& pose : poses) {
    const auto lattice = to_lattice(pose, scene.loaded.geometry);
    if (!lattice) return lattice.error();
    out.poses.push_back(*lattice);
  }
  std::vector<std::uint8_t> bits(poses.size());
  if (auto done = scene.backend->touches(out.poses, bits); !done) return done;
  out.total_us = watch.us();
  return {};
}

/// Frames of a batch: contacts and responses, piece by piece on all threads, as the library asks for them.
Result<void> ask_frames(HostedScene& scene, std::span<const Pose> poses, BatchAnswer& out) {
  const Stopwatch watch(false);
  const SceneGeometry& geometry = scene.loaded.geometry;
  const ResponseSettings& settings = scene.loaded.scene.response;
  out.poses.resize(poses.size());
  out.contacts.resize(poses.size());
  out.responses.resize(poses.size());
  const std::size_t each = scene.backend->poses_together(poses.size());
  const auto ask = [&](PoseQuery& asked, std::size_t piece) -> Result<void> {
    const std::size_t first = piece * each, count = std::min(each, poses.size() - first);
    std::vector<Contacts*> contacts;
    for (std::size_t i = first; i < first + count; ++i) {
      const auto lattice = to_lattice(poses[i], geometry);
      if (!lattice) return lattice.error();
      out.poses[i] = *lattice;
      contacts.push_back(&out.contacts[i]);
    }
    if (auto done = asked.query_together(std::span(out.poses).subspan(first, count), contacts); !done)
      return done;
    for (std::size_t i = first; i < first + count; ++i)
      respond(out.contacts[i], out.poses[i], geometry, settings.profile, settings.stiffness_n_per_m,
              out.responses[i]);
    return {};
  };
  if (auto done = scene.backend->share((poses.size() + each - 1) / each, ask); !done) return done;
  out.total_us = watch.us();
  return {};
}

/// Goes through all poses once; µs a pose.
Result<double> ask_all(const Series& series, HostedScene& scene, std::span<const Pose> all, Answer& answer,
                       BatchAnswer& batch) {
  double us = 0;
  for (std::size_t first = 0; first < all.size(); first += std::max<std::size_t>(series.size, 1)) {
    const auto poses =
        all.subspan(first, std::min(std::max<std::size_t>(series.size, 1), all.size() - first));
    Result<void> done = {};
    if (series.wanted == Wanted::kTouch) {
      done = ask_touches(scene, poses, batch);
      answer.total_us = batch.total_us;
    } else if (series.size == 0)
      done = series.wanted == Wanted::kAnswers ? answer_pose(scene, poses.front(), answer)
                                               : answer_frame(scene, poses.front(), answer);
    else
      done = series.wanted == Wanted::kAnswers ? answer_batch(scene, poses, batch)
                                               : ask_frames(scene, poses, batch);
    if (!done) return done.error();
    us += series.size == 0 ? answer.total_us : batch.total_us;
  }
  return us / static_cast<double>(all.size());
}

/// In turns: single poses, then a batch of each size, again and again; the first round warms up.
Result<void> measure(const BenchOptions& options, HostedScene& scene, const std::vector<Pose>& poses,
                     std::initializer_list<Wanted> what, Console& console, std::vector<Series>& measured) {
  std::vector<Series> out;
  for (const Wanted wanted : what) {
    out.push_back({wanted, 0, {}, {}});
    for (const std::size_t size : batch_sizes(options.largest_batch)) out.push_back({wanted, size, {}, {}});
  }
  // The same poses for all: as many as the largest batch has, gone through as often as need be.
  std::vector<Pose> all;
  for (std::size_t i = 0; i < options.largest_batch; ++i) all.push_back(poses[i % poses.size()]);
  Answer answer;
  BatchAnswer batch;
  console.step("measuring");
  for (std::uint64_t round = 0; round <= options.rounds; ++round)
    for (Series& series : out) {
      const DeviceWork before = scene.backend->device_work();
      const std::uint64_t size = std::max<std::size_t>(series.size, 1);
      const auto some = std::span<const Pose>(all).first(
          std::min<std::size_t>(all.size(), std::max(kLeastPoses, kBatches * size)));
      const std::uint64_t batches = (some.size() + size - 1) / size;
      const auto us = ask_all(series, scene, some, answer, batch);
      if (!us) return us.error();
      series.work = since(before, scene.backend->device_work());
      for (const auto member : {&DeviceWork::submissions, &DeviceWork::dispatches, &DeviceWork::barriers,
                                &DeviceWork::bytes_up, &DeviceWork::bytes_down})
        series.work.*member /= batches;
      series.work.host_us /= static_cast<double>(batches);
      if (round > 0) series.pose_us.push_back(*us);
      if (!console.progress("poses", static_cast<double>(round) / static_cast<double>(options.rounds + 1)))
        return Error{ErrorCode::kInternal, "interrupted"};
    }
  console.finish();
  measured.insert(measured.end(), out.begin(), out.end());
  return {};
}

/// Forces first, under a plan that leaves lists out; then the rest.
Result<std::vector<Series>> measure_all(const BenchOptions& options, HostedScene& scene,
                                        const std::vector<Pose>& poses, Console& console) {
  std::vector<Series> out;
  Plan bare = scene.plan.plan;
  bare.telemetry = false;
  if (auto done = scene.backend->replan(bare); !done) return done.error();
  if (auto done = measure(options, scene, poses, {Wanted::kTouch, Wanted::kForces}, console, out); !done)
    return done.error();
  if (auto done = scene.backend->replan(scene.plan.plan); !done) return done.error();
  if (auto done = measure(options, scene, poses, {Wanted::kFrames, Wanted::kAnswers}, console, out); !done)
    return done.error();
  return out;
}

}  // namespace

Result<void> bench_throughput(const BenchOptions& options, const Parts& parts) {
  catch_interrupts();
  Console console;
  BenchFacts facts{.command = "throughput", .device = {}, .more = {}};
  BenchTable table{{"scene", "backend", "asked", "batch", "poses_per_s", "pose_us", "share_of_single"}, {}};
  table.columns.insert(table.columns.end(), kWorkColumns.begin(), kWorkColumns.end());
  Chart chart{.title = "Poses a second",
              .unit = "1/s",
              .labels = {},
              .series = {},
              .log_x = true,
              .x_title = "poses a batch"};
  const double load = load_average();
  for (const std::string& file : options.scenes)
    for (const std::string& wanted : asked_backends(options)) {
      auto prepared = ready_scene(options, file, wanted, Purpose::kQuery, parts, console);
      if (!prepared) return prepared.error();
      HostedScene& scene = **prepared;
      const Result<std::vector<Pose>> poses = bench_poses(options, scene, parts, console);
      if (!poses) return poses.error();
      const auto outcome = measure_all(options, scene, *poses, console);
      if (!outcome) return outcome.error();
      const std::string name = scene_name(file), backend = scene.backend->name();
      double single = 0;
      Chart::Series line{};
      for (const Series& series : *outcome) {
        const double us = mean(series.pose_us);
        const std::string asked = kWantedNames[static_cast<std::size_t>(series.wanted)];
        if (series.size == 0) {
          single = us;
          line = {name + ", " + backend + ", " + asked, {}, {}};
        } else {
          line.x.push_back(static_cast<double>(series.size));
          line.y.push_back(1e6 / us);
          if (series.size == options.largest_batch) chart.series.push_back(line);
        }
        auto& row = table.rows.emplace_back(std::vector<BenchCell>{
            name, backend, asked,
            series.size == 0 ? BenchCell(std::string("single")) : BenchCell(std::uint64_t{series.size}),
            1e6 / us, us, us / single});
        for (BenchCell& cell : work_cells(series.work)) row.push_back(std::move(cell));
      }
      facts.add_device(device_text(*scene.backend, parts));
      facts.more.emplace_back(name + ", " + backend, fmt::format("{} poses", poses->size()));
    }
  facts.more.emplace_back("clock", "wall");
  facts.more.emplace_back("load average",
                          fmt::format("{:.1f} at the start, {:.1f} at the end", load, load_average()));
  return write_bench(options.out, facts, table, {chart});
}

}  // namespace palpate

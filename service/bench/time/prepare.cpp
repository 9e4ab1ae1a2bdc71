#include <fmt/format.h>

#include <algorithm>
#include <map>
#include <optional>
#include <string_view>

#include "service/bench/bench.h"
#include "service/bench/output.h"
#include "service/bench/time/process_memory.h"
#include "service/bench/time/times.h"
#include "service/cli/numbers.h"
#include "service/cli/scene_host.h"
#include "service/report/run_summary.h"

namespace palpate {
namespace {

/// What progress tells, as times of stages.
class StageWatch {
 public:
  explicit StageWatch(bool cpu_clock) : cpu_clock_(cpu_clock), since_(cpu_clock) {}
  void at(const std::string& stage) {
    if (stage == now_) return;
    end();
    now_ = stage;
    since_ = Stopwatch(cpu_clock_);
  }
  void end() {
    if (now_.empty()) return;
    auto found = std::find_if(seconds.begin(), seconds.end(), [&](const auto& s) { return s.first == now_; });
    if (found == seconds.end()) found = seconds.insert(found, {now_, 0.0});
    found->second += since_.us() * 1e-6;
    now_.clear();
  }
  std::vector<std::pair<std::string, double>> seconds;

 private:
  bool cpu_clock_;
  Stopwatch since_;
  std::string now_;
};

struct Start {
  std::unique_ptr<HostedScene> scene;
  StageWatch stages;
  double seconds = 0, prepare_s = 0;  ///< the whole, and what comes after reading
  std::uint64_t peak = 0;
};

Result<Start> start(const BenchOptions& options, const std::string& file, bool anew, const Parts& parts,
                    Console& console) {
  Start out{nullptr, StageWatch(options.cpu_clock), 0, 0, 0};
  if (parts.cache) parts.cache->begin_anew(anew);
  restart_peak_memory();
  std::optional<Stopwatch> preparing;
  const PrepareWatch watch{.note = [&](const std::string& sentence) { console.note(sentence); },
                           .step =
                               [&](const char* step) {
                                 console.step(step);
                                 out.stages.at(step);
                                 if (std::string_view(step) == "preparing the scene")
                                   preparing.emplace(options.cpu_clock);
                               },
                           .progress =
                               [&](const char* what, double done) {
                                 out.stages.at(what);
                                 return console.progress(what, done);
                               },
                           .admit = {},
                           .cached = true,
                           .folder = {}};
  const Stopwatch whole(options.cpu_clock);
  auto made =
      prepare_scene({file, options.backends.empty() ? "" : options.backends.front(), options.profile, false},
                    Purpose::kQuery, parts, watch);
  out.seconds = whole.us() * 1e-6;
  if (preparing) out.prepare_s = preparing->us() * 1e-6;
  out.stages.end();
  if (parts.cache) parts.cache->begin_anew(false);
  if (!made) return made.error();
  out.scene = std::move(*made);
  out.peak = peak_memory();
  return out;
}

}  // namespace

Result<void> bench_prepare(const BenchOptions& options, const Parts& parts) {
  catch_interrupts();
  Console console;
  BenchFacts facts{.command = "prepare", .device = {}, .more = {}};
  BenchTable table{{"scene", "who", "stage", "seconds", "us_per_triangle", "times_fcl",
                    "kept_bytes_per_triangle", "peak_bytes"},
                   {}};
  Chart chart{.title = "Preparation",
              .unit = "µs a triangle",
              .labels = {},
              .series = {{"whole", {}, {}}},
              .x_title = {}};
  const double load = load_average();
  const std::string none;
  for (const std::string& file : options.scenes) {
    const std::string name = scene_name(file);
    struct Line {
      std::string who, stage;
      double seconds;
      BenchCell kept, peak;
    };
    std::vector<Line> lines;
    double fcl_s = 0, triangles = 0;
    for (const bool anew : {true, false}) {
      if (!anew && !parts.cache) continue;
      auto begun = start(options, file, anew, parts, console);
      if (!begun) return begun.error();
      console.finish();
      const HostedScene& scene = *begun->scene;
      const SceneGeometry& geometry = scene.loaded.geometry;
      triangles = static_cast<double>(geometry.mockup.triangles.size() + geometry.tool.triangles.size());
      const double kept = static_cast<double>(scene.backend->memory_bytes()) / triangles;
      // Of which what took long enough comes from the cache (docs/CACHE.md).
      const std::string who = anew ? "palpate, first start" : "palpate, second start";
      lines.push_back({who, "whole start", begun->seconds, kept, begun->peak});
      lines.push_back({who, "meshes and lattice", begun->seconds - begun->prepare_s, none, none});
      lines.push_back({who, "preparation", begun->prepare_s, none, none});
      for (const auto& [stage, seconds] : begun->stages.seconds)
        if (seconds > 0.0005) lines.push_back({who, "- " + stage, seconds, none, none});
      // Made for loops before they begin, and else beside queries; here, so that no other stage's time has a
      // part of it.
      const Stopwatch pipelines(options.cpu_clock);
      if (auto done = begun->scene->backend->finish_preparing(); !done) return done.error();
      lines.push_back({who, "pipelines of frames", pipelines.us() * 1e-6, none, none});
      if (!anew) continue;
      facts.device = device_text(*scene.backend, parts);
      if (const std::uint64_t bytes = scene.backend->preparation_bytes(geometry, scene.plan.plan); bytes > 0)
        facts.more.emplace_back(
            name, fmt::format("{} triangles; preparing was expected to take up to {} on the device",
                              count_text(geometry.mockup.triangles.size()), bytes_text(bytes)));
      if (!parts.make_peers) continue;
      for (auto& peer : parts.make_peers()) {
        if (!console.progress(peer->name().c_str(), 0)) return Error{ErrorCode::kInternal, "interrupted"};
        const Stopwatch watch(options.cpu_clock);
        peer->build(geometry);
        const double seconds = watch.us() * 1e-6;
        if (peer->name() == "FCL OBB") fcl_s = seconds;
        lines.push_back({peer->name(), "trees", seconds, none, none});
      }
      console.finish();
    }
    for (const Line& line : lines) {
      const double us = 1e6 * line.seconds / triangles;
      table.rows.push_back({name, line.who, line.stage, line.seconds, us,
                            fcl_s > 0 ? BenchCell(line.seconds / fcl_s) : BenchCell(none), line.kept,
                            line.peak});
      if (line.stage != "preparation" && line.stage != "trees") continue;
      chart.labels.push_back(name + ", " + line.who);
      chart.series.front().y.push_back(us);
    }
  }
  facts.more.emplace_back("other libraries", parts.make_peers
                                                 ? "their trees, on the same triangles, in the same run"
                                                 : "not in this build (PALPATE_BENCH_PEERS)");
  facts.more.emplace_back("clock", options.cpu_clock ? "CPU time of this process" : "wall");
  facts.more.emplace_back("load average",
                          fmt::format("{:.1f} at the start, {:.1f} at the end", load, load_average()));
  return write_bench(options.out, facts, table, {chart});
}

}  // namespace palpate

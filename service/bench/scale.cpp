#include <fmt/format.h>

#include <filesystem>
#include <fstream>
#include <map>
#include <nlohmann/json.hpp>

#include "service/bench/bench.h"
#include "service/bench/output.h"
#include "service/bench/poses.h"
#include "service/bench/process_memory.h"
#include "service/bench/times.h"
#include "service/cli/answer.h"

namespace palpate {
namespace {

using Json = nlohmann::ordered_json;

constexpr std::uint64_t kContact = 100'000, kTool = 2'000;   // triangles of the chapter's scene, to which the series are compared
constexpr double kAside_m = 2;                               // where triangles that nobody touches stand

/// A scene of one of three series: triangles added around the same contact; the same surface, finer; a finer tool.
struct Case {
  const char* series;
  std::uint64_t triangles, tool;
};

std::vector<Case> cases(std::uint64_t most) {
  std::vector<Case> out;
  for (std::uint64_t n = kContact; n <= most; n *= 10) out.push_back({"around", n, kTool});
  for (std::uint64_t n = 10'000; n <= most; n *= 10) out.push_back({"finer", n, kTool});
  for (const std::uint64_t n : {std::uint64_t{1'000}, std::uint64_t{10'000}, std::uint64_t{100'000}}) out.push_back({"tool", kContact, n});
  return out;
}

Json generated(const char* name, const char* body, std::uint64_t triangles) {
  return {{"generate", {{"name", name}, {"body", body}, {"triangles", triangles}}}};
}

/// `spacing_m` > 0: of samples, instead of what the program would choose.
Json scene_of(const Case& c, bool paper, double spacing_m) {
  const bool around = std::string_view(c.series) == "around";
  Json statics = Json::array({generated("disassembly", "mockup", around ? kContact : c.triangles)});
  if (around && c.triangles > kContact) {
    Json more = generated("contacts", "mockup", c.triangles - kContact);
    more["position"] = {kAside_m, 0, 0};
    statics.push_back(more);
  }
  Json tool = generated("disassembly", "tool", c.tool);
  tool["mass"] = 0.25;
  Json response = {{"profile", paper ? "paper" : "refined"}};
  if (spacing_m > 0) response["sample_spacing"] = spacing_m;
  return {{"static", statics}, {"tool", tool}, {"response", response}, {"device", {{"driver", "simulated"}}}};
}

struct Figures {
  TimeTable times;
  std::uint64_t triangles = 0, tool = 0, kept = 0, peak = 0;
  double prepare_s = 0, voxel_m = 0, spacing_m = 0;
  std::string device, backend;
};

Result<Figures> measure(const BenchOptions& options, const std::string& file, const Parts& parts, Console& console) {
  restart_peak_memory();
  auto prepared = prepare_scene({file, options.backends.empty() ? "" : options.backends.front(), options.profile, false}, Purpose::kQuery, parts, console);
  if (!prepared) return prepared.error();
  if (auto done = (*prepared)->backend->finish_preparing(); !done) return done.error();   // no frame beside compilers
  HostedScene& scene = **prepared;
  const Result<std::vector<Pose>> poses = bench_poses(options, scene, parts, console);
  if (!poses) return poses.error();
  Figures out;
  Answer answer;
  console.step("measuring");
  for (std::uint64_t round = 0; round <= options.rounds; ++round)
    for (std::size_t i = 0; i < poses->size(); ++i) {
      const Stopwatch watch(options.cpu_clock);
      if (auto done = answer_frame(scene, (*poses)[i], answer); !done) return done.error();
      if (const double us = watch.us(); round > 0) out.times.add(frame_kind(answer.contacts), us);
      if (i % 16 == 0 && !console.progress("poses", static_cast<double>(round) / static_cast<double>(options.rounds + 1))) return Error{ErrorCode::kInternal, "interrupted"};
    }
  console.finish();
  out.triangles = scene.loaded.geometry.mockup.triangles.size();
  out.tool = scene.loaded.geometry.tool.triangles.size();
  out.kept = scene.backend->memory_bytes();
  out.peak = peak_memory();
  out.prepare_s = scene.prepare_s;
  out.voxel_m = scene.loaded.geometry.lattice.step_m * scene.loaded.geometry.mockup_grid.size;
  out.spacing_m = scene.loaded.geometry.lattice.step_m * scene.loaded.geometry.sample_spacing;
  out.backend = scene.backend->name();
  out.device = device_text(*scene.backend, parts);
  return out;
}

}  // namespace

Result<void> bench_scale(const BenchOptions& options, const Parts& parts) {
  catch_interrupts();
  Console console;
  BenchFacts facts{.command = "scale", .device = {}, .more = {}};
  BenchTable table{{"series", "static_triangles", "tool_triangles", "frames", "count", "p50_us", "p99_us", "times_the_first", "times_the_last", "voxel_mm", "prepare_s", "kept_bytes", "peak_bytes", "backend"}, {}};
  BenchChart growth{.title = "Median of a frame in contact", .unit = "µs", .labels = {}, .series = {}, .log_x = true, .log_y = true, .x_title = "triangles of the mock-up, or of the tool"};
  const std::filesystem::path folder = std::filesystem::path(options.out) / "scenes";
  std::error_code error;
  std::filesystem::create_directories(folder, error);
  if (error) return bad_value(fmt::format("{}: the directory can't be made ({})", folder.string(), error.message()));
  const double load = load_average();
  std::map<std::string, double> first, last;   // by series and kind of frame: the median of its smallest scene, and of the scene before
  double around_spacing_m = 0;   // of the first: other samples would be another contact
  for (const Case& c : cases(options.most_triangles)) {
    const bool around = std::string_view(c.series) == "around";
    const std::filesystem::path file = folder / fmt::format("{}_{}_{}.json", c.series, c.triangles, c.tool);
    {
      std::ofstream out(file, std::ios::trunc);
      out << scene_of(c, options.profile == Profile::kPaper, around ? around_spacing_m : 0).dump(1) << "\n";
      if (!out.flush()) return bad_value(file.string() + ": the file can't be written");
    }
    const Result<Figures> figures = measure(options, file.string(), parts, console);
    if (!figures) return figures.error();
    if (around && around_spacing_m == 0) around_spacing_m = figures->spacing_m;
    for (std::size_t kind = 0; kind < 4; ++kind) {
      const TimePercentiles p = percentiles(figures->times.times(kind, "total"));
      if (p.count == 0) continue;
      const std::string line = fmt::format("{} {}", c.series, kind);
      const double smallest = first.emplace(line, p.p50).first->second, before = last.emplace(line, p.p50).first->second;
      last[line] = p.p50;
      table.rows.push_back({std::string(c.series), figures->triangles, figures->tool, std::string(kFrameKindNames[kind]), std::uint64_t{p.count}, p.p50, p.p99,
                            p.p50 / smallest, p.p50 / before, 1000 * figures->voxel_m, figures->prepare_s, figures->kept, figures->peak, figures->backend});
      if (kind != 0) continue;
      if (growth.series.empty() || growth.series.back().label != c.series) growth.series.push_back({c.series, {}, {}});
      growth.series.back().x.push_back(static_cast<double>(std::string_view(c.series) == "tool" ? figures->tool : figures->triangles));
      growth.series.back().y.push_back(p.p50);
    }
    facts.device = figures->device;
  }
  facts.more.emplace_back("around", fmt::format("the disassembly of {} triangles, and others {} m aside that are never touched; the samples of the first for all", kContact, kAside_m));
  facts.more.emplace_back("finer", "the same surfaces in more triangles");
  facts.more.emplace_back("tool", fmt::format("the mock-up of {} triangles, the tool's surface in more", kContact));
  facts.more.emplace_back("clock", options.cpu_clock ? "CPU time of this process" : "wall");
  facts.more.emplace_back("load average", fmt::format("{:.1f} at the start, {:.1f} at the end", load, load_average()));
  return write_bench(options.out, facts, table, {growth});
}

}  // namespace palpate

#include <fmt/format.h>

#include <array>
#include <filesystem>
#include <fstream>
#include <map>
#include <nlohmann/json.hpp>

#include "model/generate.h"
#include "model/mesh/mesh.h"
#include "model/scene/scene_file.h"
#include "service/bench/bench.h"
#include "service/bench/output.h"
#include "service/bench/poses.h"
#include "service/bench/ready_scene.h"
#include "service/bench/time/process_memory.h"
#include "service/bench/time/times.h"
#include "service/cli/answer.h"
#include "service/report/run_summary.h"

namespace palpate {
namespace {

using Json = nlohmann::ordered_json;

constexpr std::uint64_t kContact = 100'000,
                        kTool = 2'000;  // triangles of the chapter's scene, to which the series are compared
constexpr double kAside_m = 2;          // where triangles that nobody touches stand

/// A scene of one of three series: triangles added around the same contact; the same surface, finer; a finer
/// tool.
struct Case {
  const char* series;
  std::uint64_t triangles, tool;
};

std::vector<Case> cases(std::uint64_t most) {
  std::vector<Case> out;
  for (std::uint64_t n = kContact; n <= most; n *= 10) out.push_back({"around", n, kTool});
  for (std::uint64_t n = 10'000; n <= most; n *= 10) out.push_back({"finer", n, kTool});
  for (const std::uint64_t n : {std::uint64_t{1'000}, std::uint64_t{10'000}, std::uint64_t{100'000}})
    out.push_back({"tool", kContact, n});
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

/// The same surface with each edge in two: four triangles for one. Middles are those of both neighbours, to
/// the bit.
Mesh refined(const Mesh& mesh) {
  Mesh out;
  for (const auto& [i, j, k] : mesh.triangles) {
    const Vec3 &a = mesh.vertices[i], &b = mesh.vertices[j], &c = mesh.vertices[k], ab = 0.5 * (a + b),
               bc = 0.5 * (b + c), ca = 0.5 * (c + a);
    const auto first = static_cast<std::uint32_t>(out.vertices.size());
    out.vertices.insert(out.vertices.end(), {a, b, c, ab, bc, ca});
    for (const std::array<std::uint32_t, 3>& t :
         {std::array<std::uint32_t, 3>{0, 3, 5}, {3, 1, 4}, {5, 4, 2}, {3, 4, 5}})
      out.triangles.push_back({first + t[0], first + t[1], first + t[2]});
  }
  return out;
}

struct Figures {
  TimeTable times;
  std::uint64_t triangles = 0, tool = 0, kept = 0, peak = 0;
  double prepare_s = 0, voxel_m = 0, spacing_m = 0;
  std::string device, backend;
};

Result<Figures> measure(const BenchOptions& options, const std::string& file, const std::string& backend,
                        const Parts& parts, Console& console) {
  restart_peak_memory();
  auto prepared = ready_scene(options, file, backend, Purpose::kQuery, parts, console);
  if (!prepared) return prepared.error();
  HostedScene& scene = **prepared;
  const Result<std::vector<Pose>> poses = bench_poses(options, scene, parts, console);
  if (!poses) return poses.error();
  Figures out;
  Answer answer;
  console.step("measuring");
  for (std::uint64_t round = 0; round <= options.rounds; ++round)
    for (std::size_t i = 0; i < poses->size(); ++i) {
      const DeviceWork before = scene.backend->device_work();
      const Stopwatch watch(options.cpu_clock);
      if (auto done = answer_frame(scene, (*poses)[i], answer); !done) return done.error();
      const double us = watch.us();
      if (round > 0) out.times.add(answer.contacts, us, since(before, scene.backend->device_work()));
      if (i % 16 == 0 &&
          !console.progress("poses", static_cast<double>(round) / static_cast<double>(options.rounds + 1)))
        return Error{ErrorCode::kInternal, "interrupted"};
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

/// A scene of the bench: its file, and the series that it belongs to.
struct Step {
  std::string series, file;
  bool of_tool = false;        ///< the tool's triangles are what grows
  bool keeps_samples = false;  ///< has the samples of its series' first
};

/// Rows and curve of all steps. `write` makes a step's file once it is known how far apart the first's
/// samples are (0: not yet).
class Scale {
 public:
  Scale(const BenchOptions& options, const Parts& parts) : options_(options), parts_(parts) {}
  static BenchTable columns() {
    BenchTable table{
        {"series", "static_triangles", "tool_triangles", "frames", "count", "p50_us", "p99_us",
         "times_the_first", "times_the_last", "voxel_mm", "prepare_s", "kept_bytes", "peak_bytes", "backend"},
        {}};
    table.columns.insert(table.columns.end(), kWorkColumns.begin(), kWorkColumns.end());
    return table;
  }

  template <class Write>
  Result<void> add(const Step& step, Write write) {
    const double spacing_m =
        step.keeps_samples && spacing_m_.count(step.series) != 0 ? spacing_m_.at(step.series) : 0;
    if (auto written = write(spacing_m); !written) return written;
    for (const std::string& backend : asked_backends(options_))
      if (auto done = add(step, backend); !done) return done;
    return {};
  }

  void tell(const std::string& name, const std::string& what) { facts_.more.emplace_back(name, what); }
  Console& console() { return console_; }
  Result<void> write() {
    facts_.more.emplace_back("clock", options_.cpu_clock ? "CPU time of this process" : "wall");
    facts_.more.emplace_back("load average",
                             fmt::format("{:.1f} at the start, {:.1f} at the end", load_, load_average()));
    std::vector<Chart> charts;
    for (auto& [backend, chart] : growth_) charts.push_back(std::move(chart));
    return write_bench(options_.out, facts_, table_, charts);
  }

 private:
  /// The step's rows of one engine.
  Result<void> add(const Step& step, const std::string& backend) {
    const Result<Figures> figures = measure(options_, step.file, backend, parts_, console_);
    if (!figures) return figures.error();
    spacing_m_.emplace(step.series, figures->spacing_m);
    for (std::size_t kind = 0; kind < 4; ++kind) {
      const TimePercentiles p = percentiles(figures->times.times(kind, "total"));
      if (p.count == 0) continue;
      const std::string line = fmt::format("{} {} {}", step.series, kind, figures->backend);
      const double smallest = first_.emplace(line, p.p50).first->second,
                   before = last_.emplace(line, p.p50).first->second;
      last_[line] = p.p50;
      table_.rows.push_back({step.series, figures->triangles, figures->tool,
                             std::string(kFrameKindNames[kind]), std::uint64_t{p.count}, p.p50, p.p99,
                             p.p50 / smallest, p.p50 / before, 1000 * figures->voxel_m, figures->prepare_s,
                             figures->kept, figures->peak, figures->backend});
      for (BenchCell& cell : work_cells(figures->times.work(kind)))
        table_.rows.back().push_back(std::move(cell));
      if (kind != 0) continue;
      Chart& growth = growth_
                          .try_emplace(figures->backend,
                                       Chart{.title = "Median of a frame in contact, " + figures->backend,
                                             .unit = "µs",
                                             .labels = {},
                                             .series = {},
                                             .log_x = true,
                                             .log_y = true,
                                             .x_title = "triangles of the mock-up, or of the tool"})
                          .first->second;
      if (growth.series.empty() || growth.series.back().label != step.series)
        growth.series.push_back({step.series, {}, {}});
      growth.series.back().x.push_back(
          static_cast<double>(step.of_tool ? figures->tool : figures->triangles));
      growth.series.back().y.push_back(p.p50);
    }
    facts_.add_device(figures->device);
    return {};
  }

  const BenchOptions& options_;
  const Parts& parts_;
  Console console_;
  double load_ = load_average();
  std::map<std::string, double> first_,
      last_;  ///< by series, kind of frame and engine: the median of its smallest scene, and of the one
              ///< before
  std::map<std::string, double>
      spacing_m_;  ///< by series, of its first: other samples would be another contact
  BenchFacts facts_{.command = "scale", .device = {}, .more = {}};
  BenchTable table_ = columns();
  std::map<std::string, Chart> growth_;  ///< by engine
};

Result<void> write_json(const std::string& file, const Json& scene) {
  std::ofstream out(file, std::ios::trunc);
  out << scene.dump(1) << "\n";
  if (!out.flush()) return bad_value(file + ": the file can't be written");
  return {};
}

Result<void> measure_generated(const BenchOptions& options, const std::filesystem::path& folder,
                               Scale& scale) {
  for (const Case& c : cases(options.most_triangles)) {
    const bool around = std::string_view(c.series) == "around";
    const std::string file = (folder / fmt::format("{}_{}_{}.json", c.series, c.triangles, c.tool)).string();
    const Step step{c.series, file, std::string_view(c.series) == "tool", around};
    if (auto done = scale.add(step,
                              [&](double spacing_m) {
                                return write_json(file,
                                                  scene_of(c, options.profile == Profile::kPaper, spacing_m));
                              });
        !done)
      return done;
  }
  scale.tell("around", fmt::format("the disassembly of {} triangles, and others {} m aside that are never "
                                   "touched; the samples of the first for all",
                                   kContact, kAside_m));
  scale.tell("finer", "the same surfaces in more triangles");
  scale.tell("tool", fmt::format("the mock-up of {} triangles, the tool's surface in more", kContact));
  return {};
}

/// A scene as it is, with each edge in two, and in four.
Result<void> measure_refined(const BenchOptions& options, const std::string& scene_file,
                             const std::filesystem::path& folder, Scale& scale) {
  const std::string name = scene_name(scene_file);
  if (auto done = scale.add({name, scene_file, false, true}, [](double) { return Result<void>(); }); !done)
    return done;
  auto scene = read_scene(scene_file, options.profile);
  if (!scene) return scene.error();
  auto meshes = import_scene(*scene, {});
  if (!meshes) return meshes.error();
  for (const int parts : {2, 4}) {
    meshes->mockup = refined(meshes->mockup);
    meshes->tool = refined(meshes->tool);
    const std::string stem = fmt::format("{}_{}", name, parts), file = (folder / (stem + ".json")).string();
    if (auto done = write_stl(folder / (stem + "_mockup.stl"), meshes->mockup); !done) return done;
    if (auto done = write_stl(folder / (stem + "_tool.stl"), meshes->tool); !done) return done;
    const auto write = [&](double spacing_m) {
      Json response = {
          {"profile",
           options.profile.value_or(scene->response.profile) == Profile::kPaper ? "paper" : "refined"},
          {"sample_spacing", spacing_m}};
      return write_json(file, {{"static", Json::array({{{"mesh", stem + "_mockup.stl"}, {"units", "m"}}})},
                               {"tool", {{"mesh", stem + "_tool.stl"}, {"units", "m"}}},
                               {"response", response}});
    };
    if (auto done = scale.add({name, file, false, true}, write); !done) return done;
  }
  scale.tell(name,
             "the scene as it is, with each edge in two, and in four: the same surfaces in 4 and 16 times "
             "the triangles; the samples of the first for all");
  return {};
}

}  // namespace

Result<void> bench_scale(const BenchOptions& options, const Parts& parts) {
  catch_interrupts();
  if (!options.scenes.empty() && (options.poses.empty() || options.poses == "run"))
    return Error{ErrorCode::kUsage,
                 "bench scale: a scene of one's own wants poses: name a file with --poses (a refined scene "
                 "has no path)"};
  const std::filesystem::path out(options.out), folder = out / "scenes";
  std::error_code error;
  const bool fresh = !std::filesystem::exists(out, error),
             fresh_folder = !std::filesystem::exists(folder, error);
  std::filesystem::create_directories(folder, error);
  if (error)
    return bad_value(fmt::format("{}: the directory can't be made ({})", folder.string(), error.message()));
  Scale scale(options, parts);
  const auto measure_all = [&]() -> Result<void> {
    if (options.scenes.empty())
      if (auto done = measure_generated(options, folder, scale); !done) return done;
    for (const std::string& file : options.scenes)
      if (auto done = measure_refined(options, file, folder, scale); !done) return done;
    return scale.write();
  };
  auto done = measure_all();
  if (!done && fresh_folder) std::filesystem::remove_all(folder, error);
  if (!done && fresh) std::filesystem::remove(out, error);
  return done;
}

}  // namespace palpate

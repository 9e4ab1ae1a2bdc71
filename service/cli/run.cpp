#include <fmt/format.h>

#include <cmath>
#include <cstdio>
#include <filesystem>
#include <set>
#include <string_view>
#include <vector>

#include "service/cli/cli.h"
#include "service/cli/console.h"
#include "service/cli/output_folder.h"
#include "service/cli/scene_host.h"
#include "service/cli/text_output.h"
#include "service/loop/recorder.h"
#include "service/loop/session.h"
#include "service/queries/touched_parts.h"
#include "service/report/report.h"
#include "service/report/run_summary.h"
#include "service/scene_talk.h"

namespace palpate {
namespace {

namespace fs = std::filesystem;

/// What a run shows and keeps: files, the report's curves, the live line.
class RunWatch : public RunObserver {
 public:
  RunWatch(Recorder& recorder, ReportSeries& series, Console& console, const LoadedScene& loaded)
      : recorder_(recorder),
        series_(series),
        console_(console),
        scene_(loaded.scene),
        parts_(loaded.geometry) {}

  /// Paths of the parts that have touched so far, ascending.
  const std::set<std::string>& statics() const { return statics_; }
  const std::set<std::string>& mobiles() const { return mobiles_; }

  Result<void> on_tick(const TickRecord& tick) override {
    if (auto done = recorder_.on_tick(tick); !done) return done;
    guide(tick);
    if (!console_.wants_live()) return series_.on_tick(tick);
    if (*tick.guidance != 0)
      console_.live(fmt::format("{:7.2f} s  {}", tick.time_s, tick.guidance));
    else
      console_.live(
          fmt::format("{:7.2f} s  {:5.2f} N  {:6.3f} N·m  areas {}  frame {:.2f} ms  {}  {}", tick.time_s,
                      glm::length(tick.sent.force), glm::length(tick.sent.torque), areas_, frame_us_ / 1000,
                      tick.result_age_ticks < 0 ? "no result yet"
                                                : fmt::format("ticks since result {}", tick.result_age_ticks),
                      tick.stage > 0 ? "stage " + stage_text(tick.stage, scene_.stage_names) : ""));
    return series_.on_tick(tick);
  }

  Result<void> on_frame(const FrameRecord& frame) override {
    areas_ = frame.contacts.areas.size();
    frame_us_ = frame.total_us;
    if (frame.contacts.contact) {
      for (std::string& path : parts_.statics(frame.contacts)) statics_.insert(std::move(path));
      for (std::string& path : parts_.mobiles(frame.contacts)) mobiles_.insert(std::move(path));
    }
    if (auto done = recorder_.on_frame(frame); !done) return done;
    return series_.on_frame(frame);
  }

 private:
  /// What the person at the device should do: on a terminal it takes the live line's place, elsewhere, and
  /// where all else is quiet, each new sentence is a line.
  void guide(const TickRecord& tick) {
    const std::string_view said = tick.guidance;
    if (said == guidance_) return;
    guidance_ = said;
    if (!console_.terminal() || Console::quiet())
      console_.say(said.empty() ? "the haptic device is ready" : said);
  }

  Recorder& recorder_;
  ReportSeries& series_;
  Console& console_;
  const Scene& scene_;
  TouchedParts parts_;
  std::set<std::string> statics_, mobiles_;
  std::size_t areas_ = 0;
  double frame_us_ = 0;
  std::string_view guidance_;  // text that outlives the run
};

/// What a run leaves in its directory.
constexpr const char* kRunFiles[] = {"trace.csv", "frames.jsonl", "summary.json", "report.html"};

/// Where a run's files go.
struct RunFolder {
  fs::path path;
  std::vector<fs::path> made;  ///< directories that were not there before, from the outermost on

  /// A run that never began leaves nothing.
  void take_back() const {
    std::error_code ignored;
    for (const char* file : kRunFiles) fs::remove(path / file, ignored);
    for (auto folder = made.rbegin(); folder != made.rend(); ++folder)
      fs::remove(*folder, ignored);  // those that are empty
  }
};

/// `wanted`, or a directory palpate-run-SCENE[-N] that did not exist before.
Result<RunFolder> output_directory(const std::string& wanted, const std::string& scene) {
  std::error_code error;
  if (!wanted.empty()) {
    RunFolder out{wanted, {}};
    for (fs::path above = fs::absolute(wanted, error); !error && !above.empty() && !fs::exists(above, error);
         above = above.parent_path())
      out.made.insert(out.made.begin(), above);
    fs::create_directories(wanted, error);
    if (error) return bad_value(fmt::format("{}: the directory can't be made ({})", wanted, error.message()));
    return out;
  }
  const std::string base = "palpate-run-" + scene_name(scene);
  for (int n = 1; n < 10000; ++n) {
    const fs::path candidate = n == 1 ? base : fmt::format("{}-{}", base, n);
    if (fs::create_directory(candidate, error)) return RunFolder{candidate, {candidate}};
    if (error)
      return bad_value(
          fmt::format("{}: the directory can't be made ({})", candidate.string(), error.message()));
  }
  return bad_value(fmt::format("{}-N: there are 10,000 of them already; name one with --out", base));
}

/// The plans that the run goes over to, in the order of time.
Result<std::vector<PlanChange>> read_switches(const RunOptions& options, const LoadedScene& loaded) {
  std::vector<PlanChange> out;
  const Scene& scene = loaded.scene;
  PlanFacts facts = session_facts(scene, loaded.geometry, true);
  facts.full = options.common.full_plan;
  for (const std::string& text : options.switches) {
    const std::size_t colon = text.find(':');
    const std::string word = colon == std::string::npos ? "" : text.substr(colon + 1);
    std::size_t read = 0;
    double seconds = -1;
    try {
      seconds = std::stod(text.substr(0, colon), &read);
    } catch (const std::exception&) {
    }
    if (read != std::min(colon, text.size()) || !(seconds >= 0 && seconds < 1e6) ||
        (!out.empty() && seconds * 1000 < static_cast<double>(out.back().tick)))
      return bad_value(
          fmt::format("--switch {}: a time in seconds comes first, none before the last one's", text));
    if (word == "paper" || word == "refined")
      facts.profile = word == "paper" ? Profile::kPaper : Profile::kRefined;
    else if (word == "full" || word == "auto")
      facts.full = word == "full";
    else
      return bad_value(fmt::format("--switch {}: after the colon comes paper, refined, full or auto", text));
    out.push_back({std::llround(seconds * 1000), {decide_plan(facts).plan, facts.torque_wanted}});
  }
  return out;
}

Result<void> check_options(const RunOptions& options) {
  if (!options.out.empty())
    if (auto done = check_output_folder(options.out, kRunFiles, "a run's", options.overwrite); !done)
      return done;
  if (options.duration_s && !(std::isfinite(*options.duration_s) && *options.duration_s > 0))
    return bad_value(fmt::format("--duration {} is not a positive number of seconds", *options.duration_s));
  return {};
}

}  // namespace

Result<void> run_command(const RunOptions& options, const Parts& parts) {
  if (auto done = check_options(options); !done) return done;
  Console console;
  SceneOptions common = options.common;
  common.second_backend = !options.switches.empty();
  Result<std::unique_ptr<HostedScene>> prepared = prepare_scene(common, Purpose::kRecording, parts, console);
  if (!prepared) return prepared.error();
  LoadedScene& loaded = (*prepared)->loaded;
  std::string driver = options.device.empty() ? loaded.scene.device.driver : options.device;
  if (constexpr std::string_view replay = "replay:"; driver.starts_with(replay)) {
    loaded.scene.device.replay_file = driver.substr(replay.size());
    driver = "replay";
  }
  if (!options.firmware.empty() && driver != "falcon")
    return Error{ErrorCode::kUsage,
                 fmt::format("--firmware is for the device falcon, and the device is {}", driver)};
  Result<std::unique_ptr<HapticDevice>> device =
      parts.make_device(driver, loaded.scene, loaded.geometry.tool_gc_m, options.firmware);
  if (!device) return device.error();
  if (options.asap && driver != "simulated" && driver != "replay")
    return Error{
        ErrorCode::kUsage,
        fmt::format("--pace asap is virtual time, which the device '{}' can't keep: simulated and replay can",
                    driver)};

  const Result<std::vector<PlanChange>> switches = read_switches(options, loaded);
  if (!switches) return switches.error();
  const Result<RunFolder> folder = output_directory(options.out, options.common.scene);
  if (!folder) return folder.error();
  const fs::path& directory = folder->path;
  Result<std::unique_ptr<Recorder>> recorder = Recorder::create(directory.string());
  if (!recorder) return recorder.error();

  const Result<SceneTalk> talk = scene_talk(loaded, *(*prepared)->backend);
  if (!talk) return talk.error();
  for (const auto* sentences : {&talk->start, &talk->bodies})
    for (const std::string& sentence : *sentences) console.note(sentence);

  // Until here no device has been opened, and a signal just ends the program, whatever it is busy with.
  catch_interrupts();

  // The run itself. Whatever ends it, the files are closed and whole.
  SessionOptions session;
  session.pace = options.asap ? Pace::kAsap : Pace::kRealtime;
  session.duration_s = options.duration_s;
  session.room = true;
  session.stop = &interrupt_flag();
  PlanSwitch plans(loaded.geometry, std::move((*prepared)->second));
  if (!switches->empty()) {
    session.plans = &plans;
    session.changes = *switches;
  }
  ReportSeries series(report_focus(loaded));
  RunWatch watch(**recorder, series, console, loaded);
  Result<SessionSummary> summary = run_session(loaded, *(*prepared)->backend, **device, session, &watch);
  console.finish();
  Result<void> recorded = (*recorder)->finish();
  if (!summary) {  // it never began: the device can't be opened, say
    folder->take_back();
    return summary.error();
  }
  if (!recorded) return recorded;
  summary->static_parts.assign(watch.statics().begin(), watch.statics().end());
  summary->tool_parts.assign(watch.mobiles().begin(), watch.mobiles().end());
  for (std::size_t i = 0; i < switches->size(); ++i)
    if ((*switches)[i].tick >= static_cast<std::int64_t>(summary->ticks))
      summary->notes.push_back(fmt::format("--switch {}: the run ended before it, after {} ticks of 1 ms",
                                           options.switches[i], summary->ticks));

  const ReportFacts facts{options.asap ? "asap" : "realtime", (*prepared)->load_s, (*prepared)->prepare_s,
                          provenance_of(loaded.scene, (*prepared)->plan,
                                        summary->backend + " on " + summary->device, typed_command())};
  if (auto done = write_text(directory / "summary.json", summary_json(*summary, &facts.provenance)); !done)
    return done;
  if (auto done = write_text(directory / "report.html", report_page(*summary, loaded, facts, series)); !done)
    return done;
  for (const std::string& note : summary->notes) console.note(note);
  if (summary->failure) return *summary->failure;
  fmt::print("{}{:<14} {}\n", summary_text(*summary, loaded.scene.stage_names), "files", directory.string());
  fmt::print("{:<14} {}\n", "report", (directory / "report.html").string());
  return {};
}

}  // namespace palpate

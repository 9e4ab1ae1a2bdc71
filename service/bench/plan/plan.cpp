// `palpate bench plan`: scenes that lack something, under the whole plan and under their own: the same bits,
// time and memory.
#include <fmt/format.h>

#include <algorithm>
#include <set>
#include <sstream>

#include "service/bench/bench.h"
#include "service/bench/output.h"
#include "service/bench/plan/plan_subjects.h"
#include "service/bench/plan/plan_trial.h"
#include "service/cli/console.h"
#include "service/cli/scene_host.h"

namespace palpate {
namespace {

class PlanBench {
 public:
  PlanBench(const BenchOptions& options, const Parts& parts) : options_(options), parts_(parts) {}

  Result<void> run() {
    auto backend = bench_backend(options_, parts_, console_, facts_);
    if (!backend) return backend.error();
    backend_ = std::move(*backend);
    for (const PlanSubject& subject : plan_subjects())
      if (auto done = one(subject); !done)
        return Error{done.error().code, subject.name + ": " + done.error().sentence};
    for (Chart* chart : {&time_, &memory_}) chart->series = {{"whole", {}, {}}, {"lean", {}, {}}};
    for (std::size_t k = 0; k < names_.size(); ++k)
      for (std::size_t lean = 0; lean < 2; ++lean) {
        time_.series[lean].y.push_back(us_[k][lean]);
        memory_.series[lean].y.push_back(mib_[k][lean]);
      }
    time_.labels = memory_.labels = names_;
    time_.caption =
        "The two plans in turns, each pose at its fastest round. Facts and table have the ratio of lean over "
        "whole, pose by "
        "pose: its median and a 95 % interval; where that holds 1, what was left out gives nothing "
        "measurable here.";
    console_.finish();
    what_each_gives();
    return write_bench(options_.out, facts_, table_, {time_, memory_});
  }

 private:
  /// What a scene's own plan leaves out, and what that gives there.
  struct Worth {
    std::string scene;
    std::set<std::string> left_out;
    PlanRatio time;
    double saved_mib = 0;
  };

  /// For each thing that a plan may leave out: the scenes where it gives time or memory, those first that
  /// leave out nothing else. The scene whose plan leaves out nothing was timed like all others: what it seems
  /// to gain or to lose is the measurement's own, and nothing smaller counts.
  void what_each_gives() {
    double least = 1, most = 1;  // of ratios that tell nothing
    for (const Worth& worth : worths_)
      if (worth.left_out.empty()) {
        least = std::min(least, worth.time.low);
        most = std::max(most, worth.time.high);
      }
    facts_.findings.emplace_back("",
                                 fmt::format("Of two plans that are the same one took {:.3f} to {:.3f} of "
                                             "the other's time here: what lies between tells nothing.",
                                             least, most));
    std::string slower;
    for (const Worth& worth : worths_)
      if (!worth.left_out.empty() && worth.time.low > most)
        slower += fmt::format("{}'{}' ({:.3f} of the time, {:.3f} to {:.3f})", slower.empty() ? "" : ", ",
                              worth.scene, worth.time.median, worth.time.low, worth.time.high);
    if (!slower.empty()) facts_.findings.emplace_back("", "Slower with less: " + slower + ".");
    std::set<std::string> all;
    for (const Worth& worth : worths_) all.insert(worth.left_out.begin(), worth.left_out.end());
    for (const std::string& what : all) {
      std::string alone, others;
      for (const Worth& worth : worths_) {
        if (worth.left_out.count(what) == 0) continue;
        const bool sooner = worth.time.high < least, less = worth.saved_mib >= 0.01;
        if (!sooner && !less) continue;
        std::string& list = worth.left_out.size() == 1 ? alone : others;
        list += fmt::format("{}'{}' ({}{}{})", list.empty() ? "" : ", ", worth.scene,
                            sooner ? fmt::format("{:.3f} of the time, {:.3f} to {:.3f}", worth.time.median,
                                                 worth.time.low, worth.time.high)
                                   : "",
                            sooner && less ? "; " : "",
                            less ? fmt::format("{:.2f} MiB less", worth.saved_mib) : "");
      }
      facts_.findings.emplace_back(
          "",
          what + (!alone.empty()    ? " by itself gives something in " + alone + "."
                  : !others.empty() ? " gives nothing measurable by itself; with others in " + others + "."
                                    : " gives nothing measurable in any scene on this engine."));
    }
  }

  Result<void> one(const PlanSubject& subject) {
    console_.step("plans of " + subject.name);
    const Result<SceneGeometry> geometry = build_geometry(subject.mockup, subject.tool, subject.settings);
    if (!geometry) return geometry.error();
    PlanFacts facts = facts_of(subject, *geometry);
    PlanFacts full = facts;
    full.full = true;
    if (auto done = backend_->prepare(
            *geometry, decide_plan(full).plan,
            [&](const char* what, double done_part) { return console_.progress(what, done_part); });
        !done)
      return done;
    facts.internal_voxels = full.internal_voxels = backend_->has_internal_voxels();
    const PlanDecision lean = decide_plan(facts);
    const Plan plans[] = {decide_plan(full).plan, lean.plan};

    const PlanQuestion question{&*geometry, subject.poses, 2000, options_.cpu_clock};
    PlanTrial trials[2];
    for (std::uint64_t round = 0; round < options_.rounds;
         ++round)  // in turns: other work on the machine meets both
      for (std::size_t k = 0; k < 2; ++k)
        if (auto done = try_plan(*backend_, question, plans[k], 1, trials[k]); !done) return done;
    if (const std::string differs = difference(trials[0], trials[1]); !differs.empty())
      return Error{ErrorCode::kInternal, differs};

    std::string left_out;
    for (const PlanStage& stage : lean.stages) {
      if (!stage.kept) left_out += (left_out.empty() ? "" : " ") + stage.stage;
    }
    const auto contacts = std::count_if(trials[0].frames.begin(), trials[0].frames.end(),
                                        [](const auto& frame) { return frame.contacts.contact; });
    facts_.more.emplace_back(
        subject.name,
        fmt::format(
            "{}; left out: {}; {} of {} poses in contact; the same bits in all that both plans work out",
            subject.about, left_out.empty() ? "nothing" : left_out, contacts, subject.poses.size()));
    std::set<std::string> stages;
    for (const PlanTrial& trial : trials) {
      for (const auto& [stage, us] : trial.stage_us) stages.insert(stage);
      for (const StageMemory& line : trial.memory) stages.insert(line.stage);
    }
    names_.push_back(subject.name);
    us_.push_back({});
    mib_.push_back({});
    const PlanRatio ratio = time_ratio(trials[0], trials[1]);
    const std::string ratio_text =
        fmt::format("{:.3f} ({:.3f} to {:.3f})", ratio.median, ratio.low, ratio.high);
    facts_.more.emplace_back(
        subject.name + ", lean over whole",
        ratio_text + (ratio.low <= 1 && 1 <= ratio.high ? ": no difference that can be told" : ""));
    Worth worth{subject.name,
                {},
                ratio,
                (static_cast<double>(trials[0].memory_bytes) - static_cast<double>(trials[1].memory_bytes)) /
                    1048576};
    std::istringstream words(left_out);
    for (std::string word; words >> word;) worth.left_out.insert(word);
    // One decision leaves out both.
    if (worth.left_out.erase("contact_point") > 0) worth.left_out.insert("torque");
    worths_.push_back(std::move(worth));
    for (std::size_t k = 0; k < 2; ++k) {
      const char* name = k == 0 ? "whole" : "lean";
      const PlanTrial& trial = trials[k];
      us_.back()[k] = median_frame_us(trial);
      mib_.back()[k] = static_cast<double>(trial.memory_bytes) / 1048576;
      table_.rows.push_back({subject.name, name, "total", us_.back()[k], trial.memory_bytes,
                             k == 0 ? "" : left_out, k == 0 ? BenchCell("") : BenchCell(ratio.median),
                             k == 0 ? BenchCell("") : BenchCell(ratio.low),
                             k == 0 ? BenchCell("") : BenchCell(ratio.high)});
      for (const std::string& stage : stages) {
        const auto time = trial.stage_us.find(stage);
        const auto memory = std::find_if(trial.memory.begin(), trial.memory.end(),
                                         [&](const StageMemory& line) { return line.stage == stage; });
        if (time == trial.stage_us.end() && memory == trial.memory.end()) continue;  // it isn't there
        table_.rows.push_back({subject.name, name, stage,
                               time == trial.stage_us.end() ? BenchCell("") : BenchCell(time->second),
                               memory == trial.memory.end() ? BenchCell("") : BenchCell(memory->bytes),
                               k == 0 ? "" : left_out, "", "", ""});
      }
    }
    return {};
  }

  const BenchOptions& options_;
  const Parts& parts_;
  Console console_;
  std::unique_ptr<CollisionBackend> backend_;
  BenchFacts facts_{.command = "plan", .device = {}, .more = {}};
  BenchTable table_{{"scene", "plan", "stage", "time_us_p50", "memory_bytes", "left_out", "ratio",
                     "ratio_low", "ratio_high"},
                    {}};
  Chart time_{.title = "A frame, median over the poses in contact",
              .unit = "µs",
              .labels = {},
              .series = {},
              .x_title = {}};
  Chart memory_{.title = "Memory", .unit = "MiB", .labels = {}, .series = {}, .x_title = {}};
  std::vector<Worth> worths_;
  std::vector<std::string> names_;
  std::vector<std::array<double, 2>> us_, mib_;
};

}  // namespace

Result<void> bench_plan(const BenchOptions& options, const Parts& parts) {
  catch_interrupts();
  return PlanBench(options, parts).run();
}

}  // namespace palpate

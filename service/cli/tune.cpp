// `palpate tune`: the most accurate settings of a scene inside a time budget on this machine, chosen among
// settings that were measured here.
#include "service/cli/tune.h"

#include <fmt/format.h>

#include <CLI/App.hpp>
#include <CLI/Config.hpp>
#include <CLI/Formatter.hpp>
#include <CLI/Validators.hpp>
#include <algorithm>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <nlohmann/json.hpp>

#include "model/lattice/voxel_size.h"
#include "model/scene/scene_file.h"
#include "service/bench/error/error_sweep.h"
#include "service/bench/output.h"
#include "service/bench/scene_subject.h"
#include "service/cli/number_range.h"
#include "service/cli/numbers.h"
#include "service/cli/promise.h"
#include "service/cli/scene_host.h"

namespace palpate {
namespace {

using Truths = std::vector<std::optional<ContactTruth>>;

/// Of the force's error, N.
struct Tail {
  double p50 = 0, p95 = 0, p99 = 0, max = 0;
};

Tail tail_of(const std::vector<double>& errors) {
  return {percentile(errors, 0.5), percentile(errors, 0.95), percentile(errors, 0.99), percentile(errors, 1)};
}

/// A setting that was measured.
struct Tried {
  std::string backend, device;  ///< who answered, and on what
  ErrorSetting setting;
  bool defaults = false;                         ///< the scene's own
  double d_p50 = 0, d_p99 = 0;                   ///< m
  Tail force, unseen;                            ///< at the poses that decide, and at those that only check
  std::vector<double> p50s, p95s;                ///< µs, one a measurement
  std::vector<double> unseen_errors, unseen_us;  ///< by pose, N and µs; the times of the last measurement
  std::uint64_t memory_bytes = 0;

  /// The middle ones of the measurements.
  double us_p50() const { return percentile(p50s, 0.5); }
  double us_p95() const { return percentile(p95s, 0.5); }
};

constexpr double kClose = 0.5;  ///< of the budget: nearer to it a time is measured again (like runs on a
                                ///< shared machine differ by a factor of 1.5, in processor time as well)
constexpr std::size_t kMeasurements = 5;  ///< then: odd, so that one is the middle

/// Whether a is rather to be chosen: by the tail of the force's error, which is what a hand notices, then by
/// the median. Settings that differ in voxels alone are equally accurate, and so are bounds of samples that
/// no contact reaches; then what the scene has stays, or the least memory wins, or the lower bound: no clock,
/// which would choose otherwise each time.
bool more_accurate(const Tried& a, const Tried& b) {
  if (a.force.p95 != b.force.p95) return a.force.p95 < b.force.p95;
  if (a.force.p50 != b.force.p50) return a.force.p50 < b.force.p50;
  if (a.defaults != b.defaults) return a.defaults;
  if (a.memory_bytes != b.memory_bytes) return a.memory_bytes < b.memory_bytes;
  return a.setting.geometry.contact_samples - 1 < b.setting.geometry.contact_samples - 1;  // 0: all of them
}

/// How many samples push in a contact at most, in words.
std::string bound_text(const ErrorSetting& s) {
  return s.geometry.contact_samples == 0 ? "all" : std::to_string(s.geometry.contact_samples);
}

class Tune {
 public:
  Tune(const TuneOptions& options, const Parts& parts) : options_(options), parts_(parts) {}

  Result<void> run() {
    const std::string wanted = options_.bench.backends.empty() ? "" : options_.bench.backends.front();
    if (auto done = use(wanted); !done) return done;
    const std::string first = backend_->name();
    auto read = scene_subject(options_.bench.scenes.front(), options_.bench, first, parts_, console_);
    if (!read) return read.error();
    scene_ = std::move(*read);

    // The truth: refined at a spacing beyond all that is offered, and with all samples (bench error shows how
    // far it has converged).
    finest_ = setting(Profile::kRefined, 1, scene_.voxel_m / 16, 0);
    const auto converged = answers(scene_.subject, finest_);
    if (!converged) return converged.error();
    truths_ = converged->answers;
    if (std::none_of(truths_.begin(), truths_.end(), [](const auto& truth) { return truth.has_value(); }))
      return bad_value(fmt::format("{}: none of the {} poses has a contact that pushes",
                                   options_.bench.scenes.front(), truths_.size()));
    // Every second pose in contact decides; the others tell whether that holds where nobody looked.
    seen_ = unseen_ = truths_;
    bool decides = true;
    for (std::size_t i = 0; i < truths_.size(); ++i) {
      if (!truths_[i]) continue;
      largest_force_ = std::max(largest_force_, glm::length(truths_[i]->wrench.force));
      (decides ? unseen_ : seen_)[i].reset();
      decides = !decides;
    }

    ErrorSetting own = setting(scene_.profile, 1, scene_.spacing_m);
    if (auto done = measure(own, true); !done) return done;
    // The other engine only gets its turn where it is the quicker one on the scene's own settings. Where no
    // GPU is, shaders run on this very processor, which native code uses better.
    if ((wanted.empty() || wanted == "auto") && first == "gpu" && parts_.has_gpu()) {
      if (auto done = use("cpu"); !done) return done;
      if (auto done = measure(own, true); !done) return done;
      if (tried_[1].us_p95() >= tried_[0].us_p95())
        if (auto done = use(first); !done) return done;
    }
    for (const double part : {1.0, 2.0, 4.0, 8.0})
      for (const std::uint32_t bound : {128u, 512u, 2048u, 0u})
        if (auto done = measure(setting(Profile::kRefined, 1, scene_.voxel_m / part, bound)); !done)
          return done;
    for (const double times : {1.5, 0.7})
      for (const double spacing : {scene_.spacing_m, scene_.voxel_m / 8})
        if (auto done = measure(setting(Profile::kRefined, times, spacing)); !done) return done;
    for (const double times : {1.5, 1.0, 0.7})
      if (auto done = measure(setting(Profile::kPaper, times, scene_.spacing_m)); !done) return done;
    return choose();
  }

 private:
  Result<void> use(const std::string& name) {
    auto made = choose_backend(name, std::nullopt, parts_, console_);
    if (!made) return made.error();
    backend_ = std::move(*made);
    return {};
  }

  ErrorSetting setting(Profile profile, double times, double spacing,
                       std::optional<std::uint32_t> bound = {}) const {
    ErrorSetting out{profile, "", 0, scene_.subject.settings};
    if (bound) out.geometry.contact_samples = *bound;
    out.geometry.voxel_size_m = scene_.voxel_m * times;
    out.geometry.sample_spacing_m = std::max(spacing, scene_.voxel_m * times / kMaxSamplesPerVoxelSide);
    return out;
  }

  Result<Answered> answers(const ErrorSubject& subject, const ErrorSetting& s) {
    console_.step(fmt::format("{} on {}, voxels of {:.4g} mm, samples {:.4g} mm apart, {} to a contact",
                              s.profile == Profile::kPaper ? "paper" : "refined", backend_->name(),
                              1000 * *s.geometry.voxel_size_m, 1000 * *s.geometry.sample_spacing_m,
                              bound_text(s))
                      .c_str());
    return answer_all(
        subject, s, options_.bench.rounds, *backend_,
        [this](const char* what, double done) { return console_.progress(what, done); }, cpu_clock());
  }

  /// What a processor ran is not moved by who else wants it; a device's time is no processor's.
  bool cpu_clock() const {
    return options_.clock ? *options_.clock == "cpu" : backend_->name() != "gpu" || !parts_.has_gpu();
  }

  /// Of the poses in contact, each at its fastest round.
  static std::vector<double> times_of(const Answered& answered, const Truths& truths) {
    std::vector<double> times;
    for (std::size_t i = 0; i < truths.size(); ++i)
      if (truths[i]) times.push_back(answered.times_us[i]);
    return times;
  }
  static void add_times(const Answered& answered, const Truths& truths, Tried& to) {
    const std::vector<double> times = times_of(answered, truths);
    to.p50s.push_back(percentile(times, 0.5));
    to.p95s.push_back(percentile(times, 0.95));
  }

  Result<void> measure(const ErrorSetting& s, bool defaults = false) {
    for (const Tried& t : tried_)  // the sweep may come by the scene's own settings
      if (t.backend == backend_->name() && t.setting.profile == s.profile &&
          t.setting.geometry.voxel_size_m == s.geometry.voxel_size_m &&
          (s.profile == Profile::kPaper ||
           (t.setting.geometry.sample_spacing_m == s.geometry.sample_spacing_m &&
            t.setting.geometry.contact_samples == s.geometry.contact_samples)))
        return {};
    const auto answered = answers(scene_.subject, s);
    if (!answered) {
      if (interrupted() || defaults) return answered.error();
      console_.note(answered.error().sentence + "; this setting is left out");
      return {};
    }
    const ErrorResult result = judge(*answered, seen_);
    Tried t;
    t.backend = backend_->name(), t.device = device_text(*backend_, parts_);
    t.setting = s, t.defaults = defaults;
    t.d_p50 = percentile(result.errors[0], 0.5), t.d_p99 = percentile(result.errors[0], 0.99);
    t.unseen_errors = judge(*answered, unseen_).errors[3];
    t.force = tail_of(result.errors[3]), t.unseen = tail_of(t.unseen_errors);
    add_times(*answered, seen_, t);
    t.unseen_us = times_of(*answered, unseen_);
    t.memory_bytes = backend_->memory_bytes();
    tried_.push_back(std::move(t));
    return {};
  }

  /// The most accurate within the budget. Whatever would be chosen is measured again first if it is close to
  /// the budget, until the middle of the measurements decides; so is a more accurate one just above it.
  Result<void> choose() {
    for (;;) {
      const auto best = [&](double budget) {
        Tried* out = nullptr;
        for (Tried& t : tried_)
          if (t.us_p95() <= budget && (out == nullptr || more_accurate(t, *out))) out = &t;
        return out;
      };
      Tried* candidate = nullptr;
      for (Tried& t : tried_) {
        if (t.p95s.size() >= kMeasurements ||
            std::fabs(t.us_p95() - options_.budget_us) > kClose * options_.budget_us)
          continue;
        Tried* within = best(options_.budget_us);
        if (within == nullptr || !more_accurate(*within, t)) candidate = &t;
      }
      if (candidate == nullptr) {
        if (Tried* chosen = best(options_.budget_us)) return done(*chosen);
        const auto fastest =
            std::min_element(tried_.begin(), tried_.end(),
                             [](const Tried& a, const Tried& b) { return a.us_p95() < b.us_p95(); });
        console_.finish();
        return bad_value(
            fmt::format("--budget-us {:g}: no setting that was measured keeps 95 % of the frames within it; "
                        "the fastest takes {:.0f} µs ({})",
                        options_.budget_us, fastest->us_p95(), text_of(*fastest)));
      }
      if (backend_->name() != candidate->backend)
        if (auto used = use(candidate->backend); !used) return used;
      const auto again = answers(scene_.subject, candidate->setting);
      if (!again) return again.error();
      add_times(*again, seen_, *candidate);
      candidate->unseen_us = times_of(*again, unseen_);
    }
  }

  Result<void> done(const Tried& chosen) {
    if (auto checked = check(chosen); !checked) return checked;
    if (auto printed = print(chosen); !printed || !options_.apply) return printed;
    return apply(chosen);
  }

  static std::size_t contacts_of(const Truths& truths) {
    return static_cast<std::size_t>(
        std::count_if(truths.begin(), truths.end(), [](const auto& truth) { return truth.has_value(); }));
  }

  /// Holds the choice to its promise at poses that had no part in it: every second one of those it was chosen
  /// at, and, where it was chosen at the path's, those of a hand in virtual time.
  Result<void> check(const Tried& chosen) {
    const std::size_t decided = contacts_of(seen_);
    if (!chosen.unseen_errors.empty())
      kept_.push_back(promise_kept("beside those that decided", chosen.unseen_errors, chosen.unseen_us,
                                   options_.budget_us, chosen.force.p95, decided));
    if (!options_.bench.poses.empty()) return {};
    if (backend_->name() != chosen.backend)
      if (auto used = use(chosen.backend); !used) return used;
    BenchOptions hand = options_.bench;
    hand.poses = "run";
    auto read = scene_subject(hand.scenes.front(), hand, chosen.backend, parts_, console_);
    if (!read) return read.error();
    const auto truths = answers(read->subject, finest_);
    if (!truths) return truths.error();
    if (contacts_of(truths->answers) == 0) return {};
    const auto told = answers(read->subject, chosen.setting);
    if (!told) return told.error();
    kept_.push_back(promise_kept("of a hand in virtual time", judge(*told, truths->answers).errors[3],
                                 times_of(*told, truths->answers), options_.budget_us, chosen.force.p95,
                                 decided));
    return {};
  }

  /// Writes the settings into the scene file; all else stays, in its order. A file that is not whole is
  /// never there.
  Result<void> apply(const Tried& chosen) {
    const std::string& file = options_.bench.scenes.front();
    std::ifstream in(file, std::ios::binary);
    nlohmann::ordered_json scene = nlohmann::ordered_json::parse(in, nullptr, false);
    if (!scene.is_object())
      return bad_value(file + ": the scene can't be read again, so nothing was applied");
    nlohmann::ordered_json& response = scene["response"];
    response["profile"] = chosen.setting.profile == Profile::kPaper ? "paper" : "refined";
    // As they are printed.
    response["voxel_size"] = std::stod(fmt::format("{:.6g}", *chosen.setting.geometry.voxel_size_m));
    response["sample_spacing"] = std::stod(fmt::format("{:.6g}", *chosen.setting.geometry.sample_spacing_m));
    response["contact_samples"] = chosen.setting.geometry.contact_samples;
    const std::filesystem::path target = file, beside = file + ".new";
    {
      std::ofstream out(beside, std::ios::binary | std::ios::trunc);
      out << scene.dump(2) << "\n";
      out.flush();
      if (!out) return bad_value(beside.string() + ": the file can't be written, so nothing was applied");
    }
    std::error_code error;
    if (const auto read = read_scene(beside.string(), std::nullopt); !read) {
      std::filesystem::remove(beside, error);
      return read.error();
    }
    std::filesystem::rename(beside, target, error);
    if (error)
      return bad_value(file + ": can't be replaced (" + error.message() + "), so nothing was applied");
    console_.note("applied to " + file);
    return {};
  }

  static std::string text_of(const Tried& t) {
    return fmt::format("{}, voxel_size {:.6g} m, sample_spacing {:.6g} m, contact_samples {}, {}",
                       t.setting.profile == Profile::kPaper ? "paper" : "refined",
                       *t.setting.geometry.voxel_size_m, *t.setting.geometry.sample_spacing_m,
                       t.setting.geometry.contact_samples, t.backend);
  }

  static nlohmann::ordered_json json_of(const Tried& t) {
    return {{"backend", t.backend},
            {"profile", t.setting.profile == Profile::kPaper ? "paper" : "refined"},
            {"voxel_size_m", *t.setting.geometry.voxel_size_m},
            {"sample_spacing_m", *t.setting.geometry.sample_spacing_m},
            {"contact_samples", t.setting.geometry.contact_samples},
            {"defaults", t.defaults},
            {"error_d_m", {{"p50", t.d_p50}, {"p99", t.d_p99}}},
            {"error_F_N",
             {{"p50", t.force.p50}, {"p95", t.force.p95}, {"p99", t.force.p99}, {"max", t.force.max}}},
            {"unseen_error_F_N",
             {{"p50", t.unseen.p50}, {"p95", t.unseen.p95}, {"p99", t.unseen.p99}, {"max", t.unseen.max}}},
            {"time_us", {{"p50", t.us_p50()}, {"p95", t.us_p95()}}},
            {"unseen_time_us", {{"p95", percentile(t.unseen_us, 0.95)}}},
            {"memory_bytes", t.memory_bytes}};
  }

  Result<void> print(const Tried& chosen) {
    console_.finish();
    if (options_.json) {
      nlohmann::ordered_json measured = nlohmann::ordered_json::array();
      for (const Tried& t : tried_) measured.push_back(json_of(t));
      nlohmann::ordered_json promise = nlohmann::ordered_json::array();
      for (const PromiseKept& kept : kept_)
        promise.push_back({{"poses", kept.poses},
                           {"count", kept.count},
                           {"over_p95", kept.off},
                           {"over_budget", kept.slow},
                           {"error_kept", kept.error},
                           {"time_kept", kept.time},
                           {"error_F_N", {{"p95", kept.error_p95}, {"max", kept.error_max}}},
                           {"time_us", {{"p95", kept.us_p95}}}});
      fmt::print("{}\n", nlohmann::ordered_json{{"budget_us", options_.budget_us},
                                                {"device", chosen.device},
                                                {"clock", cpu_clock() ? "cpu" : "wall"},
                                                {"largest_force_N", largest_force_},
                                                {"chosen", json_of(chosen)},
                                                {"promise", promise},
                                                {"measured", measured}}
                             .dump());
      return {};
    }
    fmt::print("{:<8} {:<4} {:>10} {:>10} {:>6}  {:>9} {:>9} {:>9}  {:>9} {:>9}  {:>9}\n", "profile", "on",
               "voxel mm", "samples mm", "most", "F off p50", "p95", "p99 N", "µs p50", "µs p95", "memory");
    for (const Tried& t : tried_)
      fmt::print(
          "{:<8} {:<4} {:>10.4g} {:>10.4g} {:>6}  {:>9.3g} {:>9.3g} {:>9.3g}  {:>9.1f} {:>9.1f}  {:>9}{}{}\n",
          t.setting.profile == Profile::kPaper ? "paper" : "refined", t.backend,
          1000 * *t.setting.geometry.voxel_size_m, 1000 * *t.setting.geometry.sample_spacing_m,
          bound_text(t.setting), t.force.p50, t.force.p95, t.force.p99, t.us_p50(), t.us_p95(),
          bytes_text(t.memory_bytes), t.defaults ? "  the scene's own" : "",
          &t == &chosen ? "  <- chosen" : "");
    fmt::print("\nThe most accurate within {:g} µs for 95 % of the frames, by the {}, on {}:\n",
               options_.budget_us, cpu_clock() ? "processor's time of all threads" : "wall's clock",
               chosen.device);
    fmt::print(
        "  \"response\": {{\"profile\": \"{}\", \"voxel_size\": {:.6g}, \"sample_spacing\": {:.6g}, "
        "\"contact_samples\": {}}}\n",
        chosen.setting.profile == Profile::kPaper ? "paper" : "refined",
        *chosen.setting.geometry.voxel_size_m, *chosen.setting.geometry.sample_spacing_m,
        chosen.setting.geometry.contact_samples);
    fmt::print(
        "It takes {:.0f} µs a frame in contact at p95 and {} of memory. Its force is off by {:.3g} N at the "
        "median, {:.3g} at p95, {:.3g} at p99 and {:.3g} at most, where the task's largest is {:.3g} N.\n",
        chosen.us_p95(), bytes_text(chosen.memory_bytes), chosen.force.p50, chosen.force.p95,
        chosen.force.p99, chosen.force.max, largest_force_);
    for (const PromiseKept& kept : kept_) fmt::print("{}\n", promise_text(kept));
    if (chosen.force.p95 > 0.25 * largest_force_)
      console_.note(fmt::format(
          "the choice is off by more than a quarter of the largest force in one frame of twenty; no "
          "setting within {:g} µs is nearer",
          options_.budget_us));
    return {};
  }

  const TuneOptions& options_;
  const Parts& parts_;
  Console console_;
  std::unique_ptr<CollisionBackend> backend_;
  SceneSubject scene_;
  ErrorSetting finest_;  ///< the truth's
  Truths truths_, seen_, unseen_;
  std::vector<PromiseKept> kept_;
  double largest_force_ = 0;  ///< N, of the truth
  std::vector<Tried> tried_;
};

}  // namespace

void add_tune_command(CLI::App& app, TuneOptions& options, const Parts& parts, Result<void>& outcome) {
  CLI::App* tune = app.add_subcommand(
      "tune", "choose the most accurate settings for a time budget on this machine, by measuring");
  options.bench.frames = 120;
  tune->add_option("scene", options.bench.scenes, "scene file (JSON)")
      ->required()
      ->expected(1)
      ->type_name("SCENE");
  tune->add_option_function<double>("--budget-us", number_within("--budget-us", 1e-3, 1e9, options.budget_us),
                                    "microseconds that 95 % of the frames in contact may take")
      ->required()
      ->type_name("N");
  tune->add_option("--poses", options.bench.poses,
                   "poses, as for query; without it the path's, deeper than a hand gets")
      ->type_name("FILE");
  tune->add_option(
          "--frames", options.bench.frames,
          "poses taken from them, evenly (120): every second one in contact decides, the others check")
      ->check(CLI::Range(std::uint64_t{1}, std::uint64_t{100000}).description(""))
      ->type_name("N");
  tune->add_option("--rounds", options.bench.rounds, "times that all poses are gone through (3)")
      ->check(CLI::Range(std::uint64_t{1}, std::uint64_t{10000}).description(""))
      ->type_name("N");
  tune->add_option("--backend", options.bench.backends,
                   "the engine, as for run; without it, on a GPU, the quicker of gpu and cpu")
      ->check(CLI::IsMember({"auto", "gpu", "cpu", "ref"}).description(""))
      ->expected(1)
      ->type_name("auto|gpu|cpu|ref");
  tune->add_option(
          "--clock", options.clock,
          "cpu: the time that this process itself ran, all its threads together; wall (cpu, on a GPU wall)")
      ->check(CLI::IsMember({"wall", "cpu"}).description(""))
      ->type_name("wall|cpu");
  tune->add_flag("--apply", options.apply, "write the choice into the scene file");
  tune->add_flag("--json", options.json, "one JSON object: chosen, measured");
  tune->footer(
      "Measures voxel size, sample spacing, contact_samples and profile as bench error does: errors are of "
      "the "
      "force, against the refined profile at a spacing of a 16th of a voxel;\n"
      "the scene's own settings are among them. The choice is by the p95 of the force's error, then by its "
      "median. A pose's "
      "time is the fastest of its rounds;\n"
      "settings within half of the budget are measured five times, and the middle decides. The choice is "
      "then "
      "held to its promise, the budget and the p95 of the\n"
      "error, at poses that had no part in it: the other half, and those of a hand in virtual time. A "
      "promise is "
      "broken where luck would look so bad in fewer than one case of twenty.");
  tune->callback([&] {
    catch_interrupts();
    outcome = Tune(options, parts).run();
    if (!outcome && interrupted()) outcome = Error{ErrorCode::kInternal, "interrupted"};
  });
}

}  // namespace palpate

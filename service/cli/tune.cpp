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
#include <nlohmann/json.hpp>

#include "model/lattice/voxel_size.h"
#include "service/bench/error/error_sweep.h"
#include "service/bench/output.h"
#include "service/bench/scene_subject.h"
#include "service/cli/numbers.h"
#include "service/cli/scene_host.h"

namespace palpate {
namespace {

/// A setting that was measured.
struct Tried {
  std::string backend;
  ErrorSetting setting;
  bool defaults = false;                ///< the scene's own
  double d_p50 = 0, d_p99 = 0;          ///< m
  double force_p50 = 0, force_p99 = 0;  ///< N
  double us_p50 = 0, us_p95 = 0;        ///< over all poses in contact and all rounds
  std::uint64_t memory_bytes = 0;
  bool refuted = false;  ///< chosen once, and over the budget when measured again
};

/// Whether a is at least as accurate: by the median error of the force, which is what is felt, then by its
/// tail.
bool more_accurate(const Tried& a, const Tried& b) {
  if (a.force_p50 != b.force_p50) return a.force_p50 < b.force_p50;
  if (a.force_p99 != b.force_p99) return a.force_p99 < b.force_p99;
  return a.us_p95 < b.us_p95;
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

    // The truth: refined at a spacing beyond all that is offered (bench error shows how far it has
    // converged).
    const auto converged = answers(setting(Profile::kRefined, 1, scene_.voxel_m / 16));
    if (!converged) return converged.error();
    truths_ = converged->answers;
    if (std::none_of(truths_.begin(), truths_.end(), [](const auto& truth) { return truth.has_value(); }))
      return bad_value(fmt::format("{}: none of the {} poses is in contact", options_.bench.scenes.front(),
                                   truths_.size()));

    ErrorSetting own = setting(scene_.profile, 1, scene_.spacing_m);
    if (auto done = measure(own, true); !done) return done;
    // The other engine only gets its turn where it is the quicker one on the scene's own settings.
    if ((wanted.empty() || wanted == "auto") && first == "gpu") {
      if (auto done = use("cpu"); !done) return done;
      if (auto done = measure(own, true); !done) return done;
      if (tried_[1].us_p95 >= tried_[0].us_p95)
        if (auto done = use(first); !done) return done;
    }
    for (const double part : {1.0, 2.0, 4.0, 8.0})
      if (auto done = measure(setting(Profile::kRefined, 1, scene_.voxel_m / part)); !done) return done;
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

  ErrorSetting setting(Profile profile, double times, double spacing) const {
    ErrorSetting out{profile, "", 0, scene_.subject.settings, 0};
    out.geometry.voxel_size_m = scene_.voxel_m * times;
    out.geometry.sample_spacing_m = std::max(spacing, scene_.voxel_m * times / kMaxSamplesPerVoxelSide);
    return out;
  }

  Result<Answered> answers(const ErrorSetting& s) {
    console_.step(fmt::format("{} on {}, voxels of {:.4g} mm, samples {:.4g} mm apart",
                              s.profile == Profile::kPaper ? "paper" : "refined", backend_->name(),
                              1000 * *s.geometry.voxel_size_m, 1000 * *s.geometry.sample_spacing_m)
                      .c_str());
    return answer_all(scene_.subject, s, options_.bench.rounds, *backend_,
                      [this](const char* what, double done) { return console_.progress(what, done); });
  }

  /// p95 over all poses in contact and all rounds.
  double p95(const Answered& answered) const {
    std::vector<double> times;
    for (std::size_t i = 0; i < truths_.size(); ++i)
      if (truths_[i]) times.insert(times.end(), answered.all_us[i].begin(), answered.all_us[i].end());
    return percentile(std::move(times), 0.95);
  }

  Result<void> measure(const ErrorSetting& s, bool defaults = false) {
    for (const Tried& t : tried_)  // the sweep may come by the scene's own settings
      if (t.backend == backend_->name() && t.setting.profile == s.profile &&
          t.setting.geometry.voxel_size_m == s.geometry.voxel_size_m &&
          (s.profile == Profile::kPaper ||
           t.setting.geometry.sample_spacing_m == s.geometry.sample_spacing_m))
        return {};
    const auto answered = answers(s);
    if (!answered) {
      if (interrupted() || defaults) return answered.error();
      console_.note(answered.error().sentence + "; this setting is left out");
      return {};
    }
    const ErrorResult result = judge(*answered, truths_);
    Tried t{backend_->name(), s, defaults};
    t.d_p50 = percentile(result.errors[0], 0.5), t.d_p99 = percentile(result.errors[0], 0.99);
    t.force_p50 = percentile(result.errors[3], 0.5), t.force_p99 = percentile(result.errors[3], 0.99);
    t.us_p50 = percentile(result.times_us, 0.5), t.us_p95 = p95(*answered);
    t.memory_bytes = backend_->memory_bytes();
    tried_.push_back(std::move(t));
    return {};
  }

  /// The most accurate within the budget, measured again to be sure; one that fails then gives way to the
  /// next.
  Result<void> choose() {
    for (;;) {
      Tried* best = nullptr;
      for (Tried& t : tried_)
        if (!t.refuted && t.us_p95 <= options_.budget_us && (best == nullptr || more_accurate(t, *best)))
          best = &t;
      if (best == nullptr) {
        const auto fastest = std::min_element(
            tried_.begin(), tried_.end(), [](const Tried& a, const Tried& b) { return a.us_p95 < b.us_p95; });
        console_.finish();
        return bad_value(
            fmt::format("--budget-us {:g}: no setting that was measured keeps 95 % of the frames within it; "
                        "the fastest takes {:.0f} µs ({})",
                        options_.budget_us, fastest->us_p95, text_of(*fastest)));
      }
      if (backend_->name() != best->backend)
        if (auto done = use(best->backend); !done) return done;
      const auto again = answers(best->setting);
      if (!again) return again.error();
      best->us_p95 = std::max(best->us_p95, p95(*again));
      if (best->us_p95 <= options_.budget_us) return print(*best);
      best->refuted = true;
    }
  }

  static std::string text_of(const Tried& t) {
    return fmt::format("{}, voxel_size {:.6g} m, sample_spacing {:.6g} m, {}",
                       t.setting.profile == Profile::kPaper ? "paper" : "refined",
                       *t.setting.geometry.voxel_size_m, *t.setting.geometry.sample_spacing_m, t.backend);
  }

  static nlohmann::ordered_json json_of(const Tried& t) {
    return {{"backend", t.backend},
            {"profile", t.setting.profile == Profile::kPaper ? "paper" : "refined"},
            {"voxel_size_m", *t.setting.geometry.voxel_size_m},
            {"sample_spacing_m", *t.setting.geometry.sample_spacing_m},
            {"defaults", t.defaults},
            {"error_d_m", {{"p50", t.d_p50}, {"p99", t.d_p99}}},
            {"error_F_N", {{"p50", t.force_p50}, {"p99", t.force_p99}}},
            {"time_us", {{"p50", t.us_p50}, {"p95", t.us_p95}}},
            {"memory_bytes", t.memory_bytes}};
  }

  Result<void> print(const Tried& chosen) {
    console_.finish();
    if (options_.json) {
      nlohmann::ordered_json measured = nlohmann::ordered_json::array();
      for (const Tried& t : tried_) measured.push_back(json_of(t));
      fmt::print("{}\n", nlohmann::ordered_json{{"budget_us", options_.budget_us},
                                                {"device", device_text(*backend_, parts_)},
                                                {"chosen", json_of(chosen)},
                                                {"measured", measured}}
                             .dump());
      return {};
    }
    fmt::print("{:<8} {:<4} {:>10} {:>10}  {:>12} {:>12}  {:>9} {:>9}  {:>9}\n", "profile", "on", "voxel mm",
               "samples mm", "F off p50 N", "F off p99 N", "µs p50", "µs p95", "memory");
    for (const Tried& t : tried_)
      fmt::print("{:<8} {:<4} {:>10.4g} {:>10.4g}  {:>12.4g} {:>12.4g}  {:>9.1f} {:>9.1f}  {:>9}{}{}\n",
                 t.setting.profile == Profile::kPaper ? "paper" : "refined", t.backend,
                 1000 * *t.setting.geometry.voxel_size_m, 1000 * *t.setting.geometry.sample_spacing_m,
                 t.force_p50, t.force_p99, t.us_p50, t.us_p95, bytes_text(t.memory_bytes),
                 t.defaults ? "  the scene's own" : "",
                 &t == &chosen ? "  <- chosen"
                 : t.refuted   ? "  over the budget when measured again"
                               : "");
    fmt::print("\nThe most accurate within {:g} µs for 95 % of the frames, on {}:\n", options_.budget_us,
               device_text(*backend_, parts_));
    fmt::print(
        "  \"response\": {{\"profile\": \"{}\", \"voxel_size\": {:.6g}, \"sample_spacing\": {:.6g}}}\n",
        chosen.setting.profile == Profile::kPaper ? "paper" : "refined",
        *chosen.setting.geometry.voxel_size_m, *chosen.setting.geometry.sample_spacing_m);
    fmt::print(
        "It costs {:.0f} µs a frame in contact at the median and {:.0f} at p95, and {} of memory; its depth "
        "is off by {:.3g} mm and its force by {:.3g} N at the median.\n",
        chosen.us_p50, chosen.us_p95, bytes_text(chosen.memory_bytes), 1000 * chosen.d_p50, chosen.force_p50);
    return {};
  }

  const TuneOptions& options_;
  const Parts& parts_;
  Console console_;
  std::unique_ptr<CollisionBackend> backend_;
  SceneSubject scene_;
  std::vector<std::optional<ContactTruth>> truths_;
  std::vector<Tried> tried_;
};

}  // namespace

void add_tune_command(CLI::App& app, TuneOptions& options, const Parts& parts, Result<void>& outcome) {
  CLI::App* tune = app.add_subcommand(
      "tune", "choose the most accurate settings for a time budget on this machine, by measuring");
  options.bench.frames = 60;
  tune->add_option("scene", options.bench.scenes, "scene file (JSON)")
      ->required()
      ->expected(1)
      ->type_name("SCENE");
  tune->add_option("--budget-us", options.budget_us,
                   "microseconds that 95 % of the frames in contact may take")
      ->required()
      ->check(CLI::Range(1e-3, 1e9).description(""))
      ->type_name("N");
  tune->add_option("--poses", options.bench.poses,
                   "poses, as for query; without it the path's, deeper than a hand gets")
      ->type_name("FILE");
  tune->add_option("--frames", options.bench.frames, "poses taken from them, evenly (60)")
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
  tune->add_flag("--json", options.json, "one JSON object: chosen, measured");
  tune->footer(
      "Measures voxel size, sample spacing and profile as bench error does: errors are of the force, against "
      "the refined profile at a spacing of a 16th of a voxel;\n"
      "the scene's own settings are among them. Other work on the machine is part of what is measured.");
  tune->callback([&] {
    catch_interrupts();
    outcome = Tune(options, parts).run();
  });
}

}  // namespace palpate

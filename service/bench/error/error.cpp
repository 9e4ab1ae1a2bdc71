// `palpate bench error`: error of the response against the time of a frame, for every knob, against closed
// forms and a converged run.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "model/generate/solids.h"
#include "model/scene/geometry_build.h"
#include "service/bench/bench.h"
#include "service/bench/error/error_charts.h"
#include "service/bench/error/error_control.h"
#include "service/bench/error/error_sweep.h"
#include "service/bench/error/plain_response.h"
#include "service/bench/output.h"
#include "service/bench/scene_subject.h"
#include "service/cli/numbers.h"
#include "service/cli/scene_host.h"

namespace palpate {
namespace {

constexpr double kConverged = 48;  ///< of a voxel: samples of a run that stands in for a closed form lie so
                                   ///< close (chosen: three times as close as the closest that is judged)
constexpr std::uint32_t kSampleCounts[] = {32, 64, 128, 256, 512, 1024, 2048};  ///< a contact; 512 is usual
constexpr std::size_t kMostTriangles =
    4'000'000;  ///< of a mock-up cut finer (chosen: minutes of preparation)

class ErrorBench {
 public:
  ErrorBench(const BenchOptions& options, const Parts& parts) : options_(options), parts_(parts) {}

  Result<void> run() {
    facts_.more.emplace_back("load average", fmt::format("{:.1f} at the start", load_average()));
    facts_.more.emplace_back(
        "clock", options_.cpu_clock ? "this process's own time, of all its threads" : "the wall's");
    if (auto done = find_engines(); !done) return done;
    if (!options_.scenes_only)
      if (auto done = closed_forms(); !done) return done;
    for (const std::string& file : options_.scenes)
      if (auto done = scene(file); !done) return done;
    if (!options_.scenes_only) {
      tessellation();
      control();
      if (auto done = lattice_step(); !done) return done;
    }
    facts_.more.emplace_back("left out",
                             "poses without contact; preparation and first-run compilation, which no time "
                             "here holds; errors of 0, for which a logarithm has no place; "
                             "spacings that a back end refuses (each with its reason); control over real "
                             "queries (bench stability has it)");
    console_.finish();
    return write_bench(options_.out, facts_, table_, charts_);
  }

 private:
  struct Engine {
    std::string name;
    std::unique_ptr<CollisionBackend> backend;
    bool paper = false;  ///< answers `paper` itself
  };

  /// Without a choice the native engine, and beside it one that answers `paper`, so that both methods are
  /// compared on one engine: the device's if there is any, else the reference.
  Result<void> find_engines() {
    std::vector<std::string> names = options_.backends;
    const bool chosen = !names.empty() && names.front() != "auto";
    if (!chosen) names = {"cpu", "gpu"};
    for (std::string name : names) {
      auto made = choose_backend(name, std::nullopt, parts_, console_);
      if (!made && !chosen && name == "gpu") {
        facts_.more.emplace_back("paper", made.error().sentence + ": the engine ref answers it");
        made = choose_backend("ref", std::nullopt, parts_, console_);
      }
      if (!made) return made.error();
      const std::string own = (*made)->name();
      facts_.device += (facts_.device.empty() ? "" : "; ") + device_text(**made, parts_);
      engines_.push_back({own, std::move(*made), own != "cpu"});
    }
    return {};
  }

  static double largest(const std::vector<std::optional<ContactTruth>>& truths, std::size_t quantity) {
    double out = 0;
    for (const auto& truth : truths)
      if (truth)
        out = std::max(out, quantity == 0   ? truth->depth
                            : quantity == 3 ? glm::length(truth->wrench.force)
                            : quantity == 4 ? glm::length(truth->wrench.torque)
                                            : 0.0);
    return out;
  }

  static ErrorTruths truths_of(const std::vector<std::optional<ContactTruth>>& truths,
                               const std::string& about, std::optional<double> spacing_m) {
    ErrorTruths out{.about = about, .spacing_m = spacing_m};
    for (std::size_t q = 0; q < out.largest.size(); ++q) out.largest[q] = largest(truths, q);
    return out;
  }

  Result<void> closed_forms() {
    std::vector<ErrorSubject> coarse = closed_form_subjects(1);
    if (options_.quick) coarse.erase(coarse.begin() + 1), coarse.pop_back();
    const double converged_part = options_.quick ? 12 : kConverged;
    struct Work {
      std::vector<std::optional<ContactTruth>> truths;
      ErrorTruths about;
      std::vector<ErrorCurves> curves;
    };
    std::vector<Work> all(coarse.size());
    for (std::size_t k = 0; k < coarse.size(); ++k) {
      if (options_.quick) coarse[k].poses.resize(8);
      const double voxel = *coarse[k].settings.voxel_size_m;
      Work& work = all[k];
      std::optional<double> stand_in;
      if (coarse[k].field_truth) {
        for (const Pose& pose : coarse[k].poses) work.truths.emplace_back(coarse[k].field_truth(pose));
      } else {
        const auto converged =
            answers(coarse[k], spacing(coarse[k].settings, voxel / converged_part), engines_.front());
        if (!converged) return converged.error();
        work.truths = converged->answers;
        stand_in = voxel / converged_part;
      }
      const std::string about = fmt::format(
          "{}; paper is judged against its closed form, refined against {}; d of the triangles themselves is "
          "off by "
          "{:.2g} of d at most",
          coarse[k].about,
          stand_in ? fmt::format("itself at a spacing of {:.3g} mm", 1000 * *stand_in) : "the field's",
          coarse[k].tessellation_error);
      facts_.more.emplace_back(coarse[k].name, about);
      work.about = truths_of(work.truths, about, stand_in);
      std::vector<ErrorSetting> settings;
      const std::vector<double> parts = options_.quick ? std::vector<double>{1, 1.5, 2, 3, 4, 6}
                                                       : std::vector<double>{1, 1.5, 2, 3, 4, 6, 8, 12, 16};
      for (const double part : parts) settings.push_back(spacing(coarse[k].settings, voxel / part));
      if (!options_.quick) {
        for (const double part : {0.35, 0.5, 0.7, 1.0, 1.4, 2.0, 2.8, 4.0})
          settings.push_back(voxels(Profile::kRefined, coarse[k].settings, voxel / part, voxel / 4));
        for (const std::uint32_t count : kSampleCounts)
          settings.push_back(samples(coarse[k].settings, count));
      }
      for (Engine& engine : engines_) {
        work.curves.push_back({engine.name, {}});
        if (auto done = measure(coarse[k], settings, work.truths, engine, work.curves.back().points); !done)
          return done;
      }
    }
    // The chapter's knob is the tessellation: its samples are centroids. The ball in a ball has its own
    // triangles.
    const std::vector<std::pair<int, std::uint64_t>> meshes = {{1, 2'500},   {4, 5'000},   {12, 10'000},
                                                               {36, 20'000}, {72, 40'000}, {108, 80'000}};
    for (std::size_t e = 0; e < engines_.size(); ++e) {
      if (!engines_[e].paper) continue;
      for (const auto& [cells, triangles] : meshes) {
        std::vector<ErrorSubject> fine = closed_form_subjects(cells, triangles);
        if (options_.quick) fine.erase(fine.begin() + 1), fine.pop_back();
        for (std::size_t k = 0; k < fine.size(); ++k) {
          if (options_.quick) fine[k].poses.resize(8);
          std::vector<std::optional<ContactTruth>> truths;
          for (const Pose& pose : fine[k].poses) truths.emplace_back(fine[k].truth(pose));
          std::vector<ErrorSetting> settings{{Profile::kPaper, "triangles",
                                              static_cast<double>(fine[k].meshes.mockup.triangles.size()),
                                              fine[k].settings, 1}};
          if (cells == 108 && !options_.quick)
            for (const double size : {5.6e-3, 4e-3, 2.8e-3, 2e-3, 1.4e-3, 1e-3})
              settings.push_back(voxels(Profile::kPaper, fine[k].settings, size, std::nullopt));
          if (auto done = measure(fine[k], settings, truths, engines_[e], all[k].curves[e].points); !done)
            return done;
        }
      }
    }
    for (std::size_t k = 0; k < coarse.size(); ++k) report(coarse[k].name, all[k].curves, all[k].about);
    return {};
  }

  void rows(const std::string& scene, const std::string& method, const std::string& knob, double value,
            const char* quantity, const std::vector<double>& errors, double us_p50, double us_p99) {
    table_.rows.push_back({scene, method, knob, value, quantity, percentile(errors, 0.5),
                           percentile(errors, 0.99), us_p50, us_p99, std::string(), errors.size(),
                           std::uint64_t{0}});
  }

  /// What a ball's triangles cost by themselves: no method can be nearer to the round ball than its mesh is.
  void tessellation() {
    BenchChart chart{.title = "sphere_plane: error of d by tessellation alone",
                     .unit = "m",
                     .labels = {},
                     .series = {{"p50", {}, {}}, {"p99", {}, {}}},
                     .log_x = true,
                     .log_y = true,
                     .x_title = "triangles of the ball"};
    std::vector<std::pair<double, double>> curve;
    for (const std::uint64_t triangles : {80u, 320u, 1280u, 5120u, 20480u, 81920u}) {
      const std::vector<double> errors = tessellation_errors(triangles);
      rows("sphere_plane", "tessellation", "tool_triangles", static_cast<double>(triangles), "d_m", errors, 0,
           0);
      for (std::size_t k = 0; k < 2; ++k) {
        chart.series[k].x.push_back(static_cast<double>(triangles));
        chart.series[k].y.push_back(percentile(errors, k == 0 ? 0.5 : 0.99));
      }
      curve.emplace_back(static_cast<double>(triangles), percentile(errors, 0.5));
    }
    facts_.more.emplace_back("order of d, tessellation",
                             order_text(*fitted_order(curve), "numbers of triangles") +
                                 ": the mesh against the round ball, no method in it");
    chart.caption =
        "How far the depth of a ball's triangles is from the round ball's: no method can be nearer than its "
        "mesh.";
    charts_.push_back(std::move(chart));
  }

  /// What a hand feels against what it should, for results of all ages, by the shipped laws in virtual time.
  void control() {
    const auto add = [&](LawKind law, int age, int n, const char* knob, double value, BenchChart& chart) {
      const ControlError result = control_error(law, age, n);
      const char* name = law == LawKind::kHold ? "hold" : law == LawKind::kPrinted ? "printed" : "corrected";
      rows("control", name, knob, value, "F_N", result.errors_n, result.step_us, result.step_us);
      for (const double fraction : {0.5, 0.99}) {
        const std::string label = fmt::format("{}, {}", name, fraction == 0.5 ? "p50" : "p99");
        auto series = std::find_if(chart.series.begin(), chart.series.end(),
                                   [&](const auto& s) { return s.label == label; });
        if (series == chart.series.end()) series = chart.series.insert(series, {label, {}, {}});
        const double error = percentile(result.errors_n, fraction);
        if (error <= 0) continue;
        series->x.push_back(value);
        series->y.push_back(error);
      }
    };
    BenchChart ages{.title = "control: force felt against force at zero delay, n = age",
                    .unit = "N",
                    .labels = {},
                    .series = {},
                    .log_x = true,
                    .log_y = true,
                    .x_title = "age of results, ticks"};
    BenchChart ramps{.title = "control: the same with results 10 ticks old, over n",
                     .unit = "N",
                     .labels = {},
                     .series = {},
                     .log_x = true,
                     .log_y = true,
                     .x_title = "n, ticks"};
    for (const LawKind law : {LawKind::kHold, LawKind::kPrinted, LawKind::kCorrected}) {
      for (const int age : {1, 2, 3, 5, 10, 20, 50}) add(law, age, age, "age", age, ages);
      if (law == LawKind::kHold) continue;
      for (const int n : {1, 2, 5, 10, 20, 50}) add(law, 10, n, "n", n, ramps);
    }
    ages.caption =
        "A hand presses a ball of 20 mm 3 mm deep into a plane, twice. The force felt is held against the "
        "force without any "
        "delay; closed form. Each law takes as many ticks to a new result as results are old.";
    ramps.caption = "The same press with results 10 ticks old: what more or fewer transitions do.";
    charts_.push_back(std::move(ages));
    charts_.push_back(std::move(ramps));
  }

  /// The mock-up grows by a small box ever further away, so that the lattice's step grows; beside it single
  /// and double precision, whose numbers lie as far apart as the contact is far from the origin.
  Result<void> lattice_step() {
    ErrorSubject corner = closed_form_subjects(1)[2];
    corner.poses.resize(10);
    const Mesh near = corner.meshes.mockup;
    const double voxel = *corner.settings.voxel_size_m;
    std::vector<std::optional<ContactTruth>> truths;
    for (const Pose& pose : corner.poses) truths.emplace_back(corner.field_truth(pose));
    const double reference_area = 0.02 * 0.02 / 64;  // of a cube of 20 mm
    BenchChart chart{.title = "corner_plane: error of d over the step between numbers",
                     .unit = "m",
                     .labels = {},
                     .series = {{"palpate", {}, {}}, {"fp32", {}, {}}, {"fp64", {}, {}}},
                     .log_x = true,
                     .log_y = true,
                     .x_title = "step, m"};
    const auto put = [&](std::size_t k, const char* method, double step, const std::vector<double>& errors,
                         double us50, double us99) {
      rows("corner_plane", method, "lattice_step", step, "d_m", errors, us50, us99);
      chart.series[k].x.push_back(step);
      chart.series[k].y.push_back(percentile(errors, 0.5));
    };
    for (const double far : {0.1, 1.0, 10.0, 100.0}) {
      corner.meshes.mockup = near;
      solids::append(corner.meshes.mockup,
                     solids::box(Vec3(far, -1e-3, -1e-2), Vec3(far + 2e-3, 1e-3, -8e-3)), "far");
      ErrorSetting setting = spacing(corner.settings, voxel / 16);
      setting.knob = "lattice_step";
      const auto geometry = build_geometry(corner.meshes.mockup, corner.meshes.tool, setting.geometry);
      if (!geometry) return geometry.error();
      if (const auto answered = answers(corner, setting, engines_.front())) {
        const ErrorResult result = judge(*answered, truths);
        put(0, "palpate", geometry->lattice.step_m, result.errors[0], percentile(result.times_us, 0.5),
            percentile(result.times_us, 0.99));
      } else if (interrupted()) {
        return answered.error();
      } else {
        facts_.more.emplace_back(fmt::format("left out of the lattice's step, {:g} m", far),
                                 answered.error().sentence);
      }
      std::vector<double> single, twice;
      Mesh moved = near;
      for (Vec3& v : moved.vertices) v.x += far;
      for (std::size_t i = 0; i < corner.poses.size(); ++i) {
        Pose pose = corner.poses[i];
        pose.position.x += far;
        single.push_back(std::fabs(plain_response<float>(moved, corner.meshes.tool, pose, voxel / 16,
                                                         corner.stiffness_n_per_m, reference_area)
                                       .depth -
                                   truths[i]->depth));
        twice.push_back(std::fabs(plain_response<double>(moved, corner.meshes.tool, pose, voxel / 16,
                                                         corner.stiffness_n_per_m, reference_area)
                                      .depth -
                                  truths[i]->depth));
      }
      put(1, "fp32", std::ldexp(1.0, std::ilogb(far) - 23), single, 0, 0);
      put(2, "fp64", std::ldexp(1.0, std::ilogb(far) - 52), twice, 0, 0);
    }
    chart.caption =
        "A cube on its corner in a plane, the same poses, ever further from the origin: palpate's lattice "
        "grows with the "
        "scene, plain numbers lie further apart. Median over ten poses, closed form.";
    charts_.push_back(std::move(chart));
    return {};
  }

  /// A hand's poses and, apart, the path's, which are deeper than a hand gets; or those of a file.
  Result<void> scene(const std::string& file) {
    if (!options_.poses.empty() || options_.quick) return scene(file, options_.poses, "");
    if (auto done = scene(file, "run", ", hand's poses"); !done) return done;
    return scene(file, "", ", path's depths");
  }

  Result<void> scene(const std::string& file, const std::string& poses, const std::string& suffix) {
    BenchOptions options = options_;
    options.poses = poses;
    auto read = scene_subject(file, options, engines_.front().name, parts_, console_);
    if (!read) return read.error();
    ErrorSubject& subject = read->subject;
    subject.name += suffix;
    const double voxel = read->voxel_m, fine = read->spacing_m;

    // What stands in for the truth. Poses without contact have nothing to judge.
    const auto converged = answers(subject, spacing(subject.settings, voxel / 16), engines_.front());
    if (!converged) return converged.error();
    const std::vector<std::optional<ContactTruth>>& truths = converged->answers;
    const auto in_contact = static_cast<std::size_t>(
        std::count_if(truths.begin(), truths.end(), [](const auto& truth) { return truth.has_value(); }));
    if (in_contact == 0) {
      const std::string sentence = fmt::format("{}: none of the {} poses is in contact", file, truths.size());
      if (suffix.empty()) return bad_value(sentence);
      console_.note(sentence + suffix);
      facts_.more.emplace_back("left out of " + subject.name, sentence);
      return {};
    }
    const std::string about = fmt::format(
        "{} of {} poses in contact; judged against refined at a spacing of {:.3g} mm, {} samples in all",
        in_contact, truths.size(), 1000 * voxel / 16, count_text(converged->samples));
    facts_.more.emplace_back(subject.name, about);
    std::vector<ErrorSetting> settings;
    for (const double part : {1.0, 1.5, 2.0, 3.0, 4.0, 6.0, 8.0})
      settings.push_back(spacing(subject.settings, voxel / part));
    std::vector<ErrorSetting> paper;
    if (!options_.quick) {
      for (const double times : {2.0, 1.4, 1.0, 0.7, 0.5, 0.35}) {
        settings.push_back(voxels(Profile::kRefined, subject.settings, voxel * times, fine));
        paper.push_back(voxels(Profile::kPaper, subject.settings, voxel * times, std::nullopt));
      }
      for (const std::uint32_t count : kSampleCounts) settings.push_back(samples(subject.settings, count));
      const std::size_t triangles = subject.meshes.mockup.triangles.size();
      for (int pieces = 1; pieces <= 6; ++pieces) {
        const std::size_t cut =
            triangles * static_cast<std::size_t>(pieces) * static_cast<std::size_t>(pieces);
        if (cut > kMostTriangles) {
          facts_.more.emplace_back(
              "left out of " + subject.name,
              fmt::format("paper with more than {} triangles", count_text(kMostTriangles)));
          break;
        }
        ErrorSetting finer = voxels(Profile::kPaper, subject.settings, voxel, std::nullopt);
        finer.knob = "triangles";
        finer.pieces = pieces;
        finer.value = static_cast<double>(cut);
        paper.push_back(finer);
      }
    }
    std::vector<ErrorCurves> curves;
    for (Engine& engine : engines_) {
      curves.push_back({engine.name, {}});
      if (auto done = measure(subject, settings, truths, engine, curves.back().points); !done) return done;
      if (engine.paper)
        if (auto done = measure(subject, paper, truths, engine, curves.back().points); !done) return done;
    }
    report(subject.name, curves, truths_of(truths, about, voxel / 16));
    return {};
  }

  static ErrorSetting spacing(const GeometrySettings& base, double value) {
    ErrorSetting setting{Profile::kRefined, "sample_spacing", value, base, 1};
    setting.geometry.sample_spacing_m = value;
    setting.geometry.contact_samples =
        0;  // all of them: else a large contact would be sampled as coarsely as before
    return setting;
  }
  static ErrorSetting voxels(Profile profile, const GeometrySettings& base, double value,
                             std::optional<double> sample_spacing) {
    ErrorSetting setting{profile, "voxel_size", value, base, 1};
    setting.geometry.voxel_size_m = value;
    setting.geometry.sample_spacing_m = sample_spacing;
    return setting;
  }

  /// The program's own spacing, and about so many samples a contact.
  static ErrorSetting samples(const GeometrySettings& base, std::uint32_t count) {
    ErrorSetting setting{Profile::kRefined, "contact_samples", static_cast<double>(count), base, 1};
    setting.geometry.contact_samples = count;
    return setting;
  }

  Result<Answered> answers(const ErrorSubject& subject, const ErrorSetting& setting, Engine& engine) {
    console_.step(fmt::format("{}: {} {} {:.4g}, {}", subject.name,
                              setting.profile == Profile::kPaper ? "paper" : "refined", setting.knob,
                              setting.value, engine.name));
    auto answered = answer_all(
        subject, setting, options_.quick ? 1 : options_.rounds, *engine.backend,
        [this](const char* what, double done) { return console_.progress(what, done); }, options_.cpu_clock);
    for (const std::string& note : engine.backend->take_notes())  // who answered is part of what a time means
      facts_.more.emplace_back(fmt::format("{}, {} {:.4g}", subject.name, setting.knob, setting.value), note);
    return answered;
  }

  Result<void> measure(const ErrorSubject& subject, const std::vector<ErrorSetting>& settings,
                       const std::vector<std::optional<ContactTruth>>& truths, Engine& engine,
                       std::vector<ErrorPoint>& points) {
    for (const ErrorSetting& setting : settings) {
      const auto answered = answers(subject, setting, engine);
      if (!answered) {
        if (interrupted()) return answered.error();
        console_.note(answered.error().sentence + "; this setting is left out");
        facts_.more.emplace_back("left out of " + subject.name, answered.error().sentence);
        continue;
      }
      points.push_back({setting, judge(*answered, truths)});
    }
    return {};
  }

  void report(const std::string& name, const std::vector<ErrorCurves>& engines, const ErrorTruths& truths) {
    for (const ErrorCurves& curves : engines) {
      for (const ErrorPoint& point : curves.points) {
        const double p50 = percentile(point.result.times_us, 0.5),
                     p99 = percentile(point.result.times_us, 0.99);
        for (std::size_t q = 0; q < kErrorQuantities.size(); ++q)
          table_.rows.push_back({name, method(point), point.setting.knob, point.setting.value,
                                 kErrorQuantities[q], percentile(point.result.errors[q], 0.5),
                                 percentile(point.result.errors[q], 0.99), p50, p99, curves.engine,
                                 point.result.times_us.size(), point.result.lost});
        if (point.result.lost > 0)
          facts_.more.emplace_back(
              fmt::format("{}, {} {} {:.4g}, {}", name, method(point), point.setting.knob,
                          point.setting.value, curves.engine),
              fmt::format("finds nothing at {} of {} poses; their d, F and T count as lost whole",
                          point.result.lost, point.result.times_us.size()));
      }
      for (const std::size_t q : {std::size_t{3}, std::size_t{0}})
        charts_.push_back(error_time_chart(name, curves, truths, q));
      add_lead(name, curves);
    }
    for (const std::size_t q : {std::size_t{3}, std::size_t{0}})
      charts_.push_back(convergence_chart(name, engines.front(), truths, q));
    if (engines.size() > 1) charts_.push_back(engines_chart(name, engines));
    std::vector<std::pair<double, double>> curve;
    for (const ErrorPoint& point : engines.front().points)
      if (point.setting.knob == "sample_spacing")
        curve.emplace_back(point.setting.value, percentile(point.result.errors[0], 0.5));
    if (const auto fit = fitted_order(curve))
      facts_.more.emplace_back("order of d, " + name, order_text(*fit, "spacings"));
  }

  static std::string method(const ErrorPoint& point) {
    return point.setting.profile == Profile::kPaper ? "paper" : "refined";
  }

  /// How much sooner refined is as good in d as the best of paper, on one engine.
  void add_lead(const std::string& name, const ErrorCurves& curves) {
    const ErrorPoint *best = nullptr, *rival = nullptr;
    const auto error = [](const ErrorPoint& p) { return percentile(p.result.errors[0], 0.5); };
    const auto time = [](const ErrorPoint& p) { return percentile(p.result.times_us, 0.5); };
    for (const ErrorPoint& p : curves.points)
      if (p.setting.profile == Profile::kPaper && (best == nullptr || error(p) < error(*best))) best = &p;
    if (best == nullptr) return;
    for (const ErrorPoint& p : curves.points)
      if (p.setting.profile == Profile::kRefined && error(p) <= error(*best) &&
          (rival == nullptr || time(p) < time(*rival)))
        rival = &p;
    facts_.more.emplace_back(
        fmt::format("refined against paper, {}, {}", name, curves.engine),
        rival == nullptr
            ? fmt::format("paper's best median error of d, {:.3g} m in {:.0f} µs, is not reached",
                          error(*best), time(*best))
            : fmt::format("paper's best median error of d is {:.3g} m in {:.0f} µs; refined has {:.3g} m in "
                          "{:.0f} µs, {:.1f} times sooner",
                          error(*best), time(*best), error(*rival), time(*rival), time(*best) / time(*rival),
                          time(*best) < 10 * time(*rival)
                              ? ": less than ten times, for here paper is fast at what little it can"
                              : ""));
  }

  const BenchOptions& options_;
  const Parts& parts_;
  Console console_;
  std::vector<Engine> engines_;
  BenchFacts facts_{.command = "error", .device = {}, .more = {}};
  BenchTable table_{{"scene", "method", "knob", "value", "quantity", "error_p50", "error_p99", "time_us_p50",
                     "time_us_p99", "engine", "poses", "lost"},
                    {}};
  std::vector<BenchChart> charts_;
};

}  // namespace

Result<void> bench_error(const BenchOptions& options, const Parts& parts) {
  catch_interrupts();
  return ErrorBench(options, parts).run();
}

}  // namespace palpate

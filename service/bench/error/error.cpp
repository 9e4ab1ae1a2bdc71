// `palpate bench error`: error of the response against the time of a frame, for every knob, against closed
// forms and a converged run.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "model/generate/solids.h"
#include "model/scene/geometry_build.h"
#include "service/bench/bench.h"
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

/// A setting that was measured.
struct Point {
  ErrorSetting setting;
  ErrorResult result;
};

class ErrorBench {
 public:
  ErrorBench(const BenchOptions& options, const Parts& parts) : options_(options), parts_(parts) {}

  Result<void> run() {
    auto backend = bench_backend(options_, parts_, console_, facts_);
    if (!backend) return backend.error();
    backend_ = std::move(*backend);
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
  Result<void> closed_forms() {
    const std::vector<ErrorSubject> coarse = closed_form_subjects(1);
    std::vector<std::vector<Point>> points(coarse.size());
    for (std::size_t k = 0; k < coarse.size(); ++k) {
      const double voxel = *coarse[k].settings.voxel_size_m;
      std::vector<std::optional<ContactTruth>> truths;
      if (coarse[k].field_truth) {
        for (const Pose& pose : coarse[k].poses) truths.emplace_back(coarse[k].field_truth(pose));
      } else {
        const auto converged = answers(coarse[k], spacing(coarse[k].settings, voxel / kConverged));
        if (!converged) return converged.error();
        truths = converged->answers;
      }
      std::vector<ErrorSetting> settings;
      for (const double part : {1.0, 2.0, 4.0, 8.0, 16.0})
        settings.push_back(spacing(coarse[k].settings, voxel / part));
      for (const double part : {0.5, 2.0, 4.0})
        settings.push_back(voxels(Profile::kRefined, coarse[k].settings, voxel / part, voxel / 4));
      if (auto done = measure(coarse[k], settings, truths, points[k]); !done) return done;
      facts_.more.emplace_back(
          coarse[k].name, fmt::format("{}; paper is judged against its closed form, refined against {}; d of "
                                      "the triangles themselves is off by {:.2g} of d at most",
                                      coarse[k].about,
                                      coarse[k].field_truth ? "the field's"
                                                            : fmt::format("itself at a spacing of {:.3g} mm",
                                                                          1000 * voxel / kConverged),
                                      coarse[k].tessellation_error));
    }
    // The chapter's knob is the tessellation: its samples are centroids.
    for (const int cells : {1, 12, 36, 108}) {
      const std::vector<ErrorSubject> fine = closed_form_subjects(cells);
      for (std::size_t k = 0; k < fine.size(); ++k) {
        if (cells > 1 && fine[k].name == "sphere_sphere") continue;  // has its 80,000 as it is
        std::vector<std::optional<ContactTruth>> truths;
        for (const Pose& pose : fine[k].poses) truths.emplace_back(fine[k].truth(pose));
        ErrorSetting setting{Profile::kPaper, "triangles",
                             static_cast<double>(fine[k].meshes.mockup.triangles.size()), fine[k].settings,
                             0};
        std::vector<ErrorSetting> settings{setting};
        if (cells == 108 || fine[k].name == "sphere_sphere")
          for (const double size : {4e-3, 1e-3})
            settings.push_back(voxels(Profile::kPaper, fine[k].settings, size, std::nullopt));
        if (auto done = measure(fine[k], settings, truths, points[k]); !done) return done;
      }
    }
    for (std::size_t k = 0; k < coarse.size(); ++k) report(coarse[k].name, points[k]);
    return {};
  }

  void rows(const std::string& scene, const std::string& method, const std::string& knob, double value,
            const char* quantity, const std::vector<double>& errors, double us_p50, double us_p99) {
    table_.rows.push_back({scene, method, knob, value, quantity, percentile(errors, 0.5),
                           percentile(errors, 0.99), us_p50, us_p99});
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
    facts_.more.emplace_back(
        "order of d, tessellation",
        fmt::format("{:.2f} in the number of triangles: the mesh against the round ball, no method in it",
                    order(curve)));
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
      if (const auto answered = answers(corner, setting)) {
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
    charts_.push_back(std::move(chart));
    return {};
  }

  Result<void> scene(const std::string& file) {
    auto read = scene_subject(file, options_, backend_->name(), parts_, console_);
    if (!read) return read.error();
    const ErrorSubject& subject = read->subject;
    const double voxel = read->voxel_m, fine = read->spacing_m;

    // What stands in for the truth, and how far it has converged. Poses without contact have nothing to
    // judge.
    std::vector<std::optional<ContactTruth>> truths;
    std::vector<Point> points;
    const auto converged = answers(subject, spacing(subject.settings, voxel / 16));
    if (!converged) return converged.error();
    truths = converged->answers;
    const auto in_contact = static_cast<std::size_t>(
        std::count_if(truths.begin(), truths.end(), [](const auto& truth) { return truth.has_value(); }));
    if (in_contact == 0)
      return bad_value(fmt::format("{}: none of the {} poses is in contact", file, truths.size()));
    facts_.more.emplace_back(
        subject.name,
        fmt::format(
            "{} of {} poses in contact; judged against refined at a spacing of {:.3g} mm, {} samples in all",
            in_contact, truths.size(), 1000 * voxel / 16, count_text(converged->samples)));
    std::vector<ErrorSetting> settings;
    for (const double part : {1.0, 2.0, 4.0, 8.0})
      settings.push_back(spacing(subject.settings, voxel / part));
    for (const double times : {1.5, 0.7})
      settings.push_back(voxels(Profile::kRefined, subject.settings, voxel * times, fine));
    for (const double times : {1.5, 1.0, 0.7})
      settings.push_back(voxels(Profile::kPaper, subject.settings, voxel * times, std::nullopt));
    ErrorSetting finer = voxels(Profile::kPaper, subject.settings, voxel, std::nullopt);
    finer.knob = "triangles";
    finer.subdivisions = 1;
    finer.value = 4 * static_cast<double>(subject.meshes.mockup.triangles.size());
    settings.push_back(finer);
    if (auto done = measure(subject, settings, truths, points); !done) return done;
    report(subject.name, points);
    return {};
  }

  static ErrorSetting spacing(const GeometrySettings& base, double value) {
    ErrorSetting setting{Profile::kRefined, "sample_spacing", value, base, 0};
    setting.geometry.sample_spacing_m = value;
    setting.geometry.contact_samples =
        0;  // all of them: else a large contact would be sampled as coarsely as before
    return setting;
  }
  static ErrorSetting voxels(Profile profile, const GeometrySettings& base, double value,
                             std::optional<double> sample_spacing) {
    ErrorSetting setting{profile, "voxel_size", value, base, 0};
    setting.geometry.voxel_size_m = value;
    setting.geometry.sample_spacing_m = sample_spacing;
    return setting;
  }

  Result<Answered> answers(const ErrorSubject& subject, const ErrorSetting& setting) {
    console_.step(fmt::format("{}: {} {} {:.4g}", subject.name,
                              setting.profile == Profile::kPaper ? "paper" : "refined", setting.knob,
                              setting.value));
    auto answered =
        answer_all(subject, setting, options_.rounds, *backend_,
                   [this](const char* what, double done) { return console_.progress(what, done); });
    for (const std::string& note : backend_->take_notes())  // who answered is part of what a time means
      facts_.more.emplace_back(fmt::format("{}, {} {:.4g}", subject.name, setting.knob, setting.value), note);
    return answered;
  }

  Result<void> measure(const ErrorSubject& subject, const std::vector<ErrorSetting>& settings,
                       const std::vector<std::optional<ContactTruth>>& truths, std::vector<Point>& points) {
    for (const ErrorSetting& setting : settings) {
      const auto answered = answers(subject, setting);
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

  void report(const std::string& name, const std::vector<Point>& points) {
    for (const Point& point : points) {
      const double p50 = percentile(point.result.times_us, 0.5),
                   p99 = percentile(point.result.times_us, 0.99);
      for (std::size_t q = 0; q < kErrorQuantities.size(); ++q)
        table_.rows.push_back({name, method(point), point.setting.knob, point.setting.value,
                               kErrorQuantities[q], percentile(point.result.errors[q], 0.5),
                               percentile(point.result.errors[q], 0.99), p50, p99});
      if (point.result.lost > 0)
        facts_.more.emplace_back(
            fmt::format("{}, {} {} {:.4g}", name, method(point), point.setting.knob, point.setting.value),
            fmt::format("finds nothing at {} of {} poses; their d, F and T count as lost whole",
                        point.result.lost, point.result.times_us.size()));
    }
    for (const std::size_t q : {std::size_t{0}, std::size_t{3}}) add_chart(name, points, q);
    add_order(name, points);
    add_lead(name, points);
  }

  static std::string method(const Point& point) {
    return point.setting.profile == Profile::kPaper ? "paper" : "refined";
  }

  void add_chart(const std::string& name, const std::vector<Point>& points, std::size_t quantity) {
    BenchChart chart{.title = fmt::format("{}: error of {} against the time of a frame, p50 and p99", name,
                                          quantity == 0 ? "d" : "F"),
                     .unit = quantity == 0 ? "m" : "N",
                     .labels = {},
                     .series = {},
                     .log_x = true,
                     .log_y = true,
                     .x_title = "µs a frame"};
    for (const double fraction : {0.5, 0.99}) {
      std::vector<BenchChart::Series> curves;
      for (const Point& point : points) {
        const std::string label =
            fmt::format("{}, {}, {}", method(point), point.setting.knob, fraction == 0.5 ? "p50" : "p99");
        auto curve =
            std::find_if(curves.begin(), curves.end(), [&](const auto& c) { return c.label == label; });
        if (curve == curves.end()) curve = curves.insert(curve, {label, {}, {}});
        const double error = percentile(point.result.errors[quantity], fraction);
        if (error <= 0) continue;  // a logarithm has no place for it
        curve->x.push_back(percentile(point.result.times_us, fraction));
        curve->y.push_back(error);
      }
      chart.series.insert(chart.series.end(), curves.begin(), curves.end());
    }
    charts_.push_back(chart);
  }

  void add_order(const std::string& name, const std::vector<Point>& points) {
    std::vector<std::pair<double, double>> curve;
    for (const Point& point : points)
      if (point.setting.knob == "sample_spacing")
        curve.emplace_back(point.setting.value, percentile(point.result.errors[0], 0.5));
    if (curve.size() >= 3)
      facts_.more.emplace_back(
          "order of d, " + name,
          fmt::format("{:.2f} in the sample spacing, fitted over {} spacings", order(curve), curve.size()));
  }

  /// Slope of log error over log knob, by least squares; values of 0 left out.
  static double order(const std::vector<std::pair<double, double>>& curve) {
    double n = 0, sx = 0, sy = 0, sxx = 0, sxy = 0;
    for (const auto& [value, error] : curve) {
      if (!(error > 0)) continue;
      const double x = std::log(value), y = std::log(error);
      n += 1, sx += x, sy += y, sxx += x * x, sxy += x * y;
    }
    return (n * sxy - sx * sy) / (n * sxx - sx * sx);
  }

  /// How much sooner refined is as good in d as the best of paper.
  void add_lead(const std::string& name, const std::vector<Point>& points) {
    const Point *best = nullptr, *rival = nullptr;
    const auto error = [](const Point& p) { return percentile(p.result.errors[0], 0.5); };
    const auto time = [](const Point& p) { return percentile(p.result.times_us, 0.5); };
    for (const Point& p : points)
      if (p.setting.profile == Profile::kPaper && (best == nullptr || error(p) < error(*best))) best = &p;
    if (best == nullptr) return;
    for (const Point& p : points)
      if (p.setting.profile == Profile::kRefined && error(p) <= error(*best) &&
          (rival == nullptr || time(p) < time(*rival)))
        rival = &p;
    facts_.more.emplace_back(
        "refined against paper, " + name,
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
  std::unique_ptr<CollisionBackend> backend_;
  BenchFacts facts_{.command = "error", .device = {}, .more = {}};
  BenchTable table_{{"scene", "method", "knob", "value", "quantity", "error_p50", "error_p99", "time_us_p50",
                     "time_us_p99"},
                    {}};
  std::vector<BenchChart> charts_;
};

}  // namespace

Result<void> bench_error(const BenchOptions& options, const Parts& parts) {
  catch_interrupts();
  return ErrorBench(options, parts).run();
}

}  // namespace palpate

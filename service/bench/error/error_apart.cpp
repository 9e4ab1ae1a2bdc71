#include "service/bench/error/error_apart.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "model/generate/solids.h"
#include "model/scene/geometry_build.h"
#include "service/bench/error/error_charts.h"
#include "service/bench/error/error_control.h"
#include "service/bench/error/error_sweep.h"
#include "service/bench/error/plain_response.h"

namespace palpate {

void ErrorApart::rows(const std::string& scene, const std::string& method, const std::string& knob,
                      double value, const char* quantity, const std::vector<double>& errors, double us_p50,
                      double us_p99) {
  table.rows.push_back({scene, method, knob, value, quantity, percentile(errors, 0.5),
                        percentile(errors, 0.99), us_p50, us_p99, std::string(), errors.size(),
                        std::uint64_t{0}, std::string()});
  for (BenchCell& cell : work_cells({})) table.rows.back().push_back(std::move(cell));
}

void ErrorApart::tessellation() {
  Chart chart{.title = "sphere_plane: error of d by tessellation alone",
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
  facts.more.emplace_back("order of d, tessellation",
                          order_text(*fitted_order(curve), "numbers of triangles") +
                              ": the mesh against the round ball, no method in it");
  chart.caption =
      "How far the depth of a ball's triangles is from the round ball's: no method can be nearer than its "
      "mesh.";
  chart.group = "Apart";
  charts.push_back(std::move(chart));
}

void ErrorApart::control() {
  const auto add = [&](LawKind law, int age, int n, const char* knob, double value, Chart& chart) {
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
  Chart ages{.title = "control: force felt against force at zero delay, n = age",
             .unit = "N",
             .labels = {},
             .series = {},
             .log_x = true,
             .log_y = true,
             .x_title = "age of results, ticks"};
  Chart ramps{.title = "control: the same with results 10 ticks old, over n",
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
  ages.group = ramps.group = "Apart";
  charts.push_back(std::move(ages));
  charts.push_back(std::move(ramps));
}

Result<void> ErrorApart::lattice_step(CollisionBackend& backend, bool cpu_clock, Console& console) {
  ErrorSubject corner = closed_form_subjects(1)[2];
  corner.poses.resize(10);
  const Mesh near = corner.meshes.mockup;
  const double voxel = *corner.settings.voxel_size_m;
  std::vector<std::optional<ContactTruth>> truths;
  for (const Pose& pose : corner.poses) truths.emplace_back(corner.field_truth(pose));
  const double reference_area = 0.02 * 0.02 / 64;  // of a cube of 20 mm
  Chart chart{.title = "corner_plane: error of d over the step between numbers",
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
    solids::append(corner.meshes.mockup, solids::box(Vec3(far, -1e-3, -1e-2), Vec3(far + 2e-3, 1e-3, -8e-3)),
                   "far");
    ErrorSetting setting{Profile::kRefined, "lattice_step", 0, corner.settings};
    setting.geometry.sample_spacing_m = voxel / 16;
    setting.geometry.contact_samples = 0;
    const auto geometry = build_geometry(corner.meshes.mockup, corner.meshes.tool, setting.geometry);
    if (!geometry) return geometry.error();
    console.step("the lattice's step");
    const auto answered = answer_all(
        corner, setting, 1, backend,
        [&](const char* what, double done) { return console.progress(what, done); }, cpu_clock);
    if (answered) {
      const ErrorResult result = judge(*answered, truths);
      put(0, "palpate", geometry->lattice.step_m, result.errors[0], percentile(result.times_us, 0.5),
          percentile(result.times_us, 0.99));
    } else if (interrupted()) {
      return answered.error();
    } else {
      facts.more.emplace_back(fmt::format("left out of the lattice's step, {:g} m", far),
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
    if (interrupted()) return Error{ErrorCode::kInternal, "interrupted"};
    put(1, "fp32", std::ldexp(1.0, std::ilogb(far) - 23), single, 0, 0);
    put(2, "fp64", std::ldexp(1.0, std::ilogb(far) - 52), twice, 0, 0);
  }
  chart.caption =
      "A cube on its corner in a plane, the same poses, ever further from the origin: palpate's lattice "
      "grows with the "
      "scene, plain numbers lie further apart. Median over ten poses, closed form.";
  chart.group = "Apart";
  charts.push_back(std::move(chart));
  return {};
}

}  // namespace palpate

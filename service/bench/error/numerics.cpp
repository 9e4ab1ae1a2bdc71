// `palpate bench numerics`: stiff and extreme cases, swept until something breaks: palpate beside the same
// method in plain single and double precision.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <map>

#include "model/generate/solids.h"
#include "model/scene/geometry_build.h"
#include "service/bench/bench.h"
#include "service/bench/error/error_sweep.h"
#include "service/bench/error/plain_response.h"
#include "service/bench/output.h"
#include "service/cli/console.h"
#include "service/cli/scene_host.h"
#include "service/loop/force_law.h"

namespace palpate {
namespace {

constexpr double kMm = 1e-3;
constexpr double kVoxel = 2 * kMm, kStiffness = 2000;
constexpr double kLost =
    0.05;  ///< of the force: beyond it an answer counts as broken (chosen: what a hand tells apart)

constexpr double kSide = 20 * kMm;  ///< of the tool, a cube

/// A cube on its corner, h deep in a plane with normal (0, 0, 1). The section is a triangle of area S = 3√3/2
/// h². Of the plane's samples the nearest of three faces is √3 h times the least of a place's barycentric
/// coordinates away, a ninth on average; the cube's own push by the volume S h / 3. So F = K / (2 A_ref) · S
/// h (√3/9 + 1/3), whatever the tessellation.
struct Extreme {
  double scale = 1;             ///< of the whole scene
  double offset = 0;            ///< m along x and, half of it, along y
  double depth = 3 * kMm;       ///< h, m before scaling
  double spacing = kVoxel / 8;  ///< m before scaling
  double stiffness = kStiffness;
  int strips =
      1;  ///< the plane's face is cut into so many along y: triangles as long as it is, and ever narrower
  double voxel = kVoxel;
};

struct Scene3 {
  Mesh mockup, tool;
  Pose pose;
  double force = 0;           ///< N, the truth; along z
  double reference_area = 0;  ///< m²: (the tool's longest side / 8)²
};

Scene3 scene_of(const Extreme& e) {
  Scene3 out;
  const double half = kSide / 2, block = 20 * kMm;
  const Vec3 away = Vec3(e.offset, e.offset / 2, 0);
  out.mockup = solids::box(Vec3(-block, -block, -block), Vec3(block, block, 0), Int3(1, e.strips, 1));
  for (Vec3& v : out.mockup.vertices) v = v * e.scale + away;
  out.tool = solids::box(Vec3(-half), Vec3(half));
  for (Vec3& v : out.tool.vertices) v *= e.scale;
  out.pose.rotation = glm::angleAxis(0.61, Vec3(0, 0, 1)) *
                      glm::angleAxis(std::atan(std::sqrt(2.0)), glm::normalize(Vec3(1, -1, 0)));
  out.pose.position = Vec3(0.617 * kMm, -0.331 * kMm, half * std::sqrt(3.0) - e.depth) * e.scale + away;
  const double h = e.depth, section = 1.5 * std::sqrt(3.0) * h * h;
  out.reference_area = kSide * e.scale * kSide * e.scale / 64;
  out.force =
      e.stiffness * e.scale * (section * h * (std::sqrt(3.0) / 9 + 1.0 / 3) / (2 * kSide * kSide / 64));
  return out;
}

struct Outcome {
  double error = 0;  ///< |ΔF| over |F|, or a probability; HUGE_VAL: no contact found
  std::string text;  ///< "held", "lost", "no contact", or why it was refused
};

Outcome judged(bool contact, const Vec3& force, double truth) {
  if (!contact) return {1, "no contact"};
  const double error =
      glm::length(force / truth - Vec3(0, 0, 1));  // in this order: a square of 1e164 N is no number
  return {std::isfinite(error) ? error : 1, error < kLost ? "held" : "lost"};
}

class NumericsBench {
 public:
  NumericsBench(const BenchOptions& options, const Parts& parts) : options_(options), parts_(parts) {}

  Result<void> run() {
    auto backend = bench_backend(options_, parts_, console_, facts_);
    if (!backend) return backend.error();
    backend_ = std::move(*backend);
    const auto powers = [](int from, int to, int step) {
      std::vector<double> out;
      for (int k = from; k <= to; k += step) out.push_back(std::pow(10.0, k));
      return out;
    };
    const auto sweep = [&](const char* name, const char* parameter, const std::vector<double>& values,
                           auto set) -> Result<void> {
      for (const double value : values) {
        Extreme extreme;
        set(extreme, value);
        if (auto done = contact_case(name, parameter, value, extreme); !done) return done;
      }
      return {};
    };
    if (auto r =
            sweep("stiffness", "K, N/m", powers(-6, 42, 6), [](Extreme& e, double k) { e.stiffness = k; });
        !r)
      return r;
    if (auto r = sweep("scale", "factor", powers(-24, 12, 2), [](Extreme& e, double s) { e.scale = s; }); !r)
      return r;
    if (auto r = sweep("offset", "m from the origin", powers(-1, 13, 1),
                       [](Extreme& e, double d) { e.offset = d; });
        !r)
      return r;
    if (auto r = sweep("aspect", "length over width of the triangles", {1, 4, 16, 64, 256, 1024, 4096},
                       [](Extreme& e, double n) { e.strips = static_cast<int>(n); });
        !r)
      return r;
    if (auto r = sweep("depth", "voxels", {0.001, 0.01, 0.1, 0.3, 1, 3, 5},
                       [](Extreme& e, double h) {
                         e.depth = h * kVoxel;
                         e.spacing = std::max(kVoxel / 60, std::min(e.spacing, e.depth / 12));
                       });
        !r)
      return r;
    if (auto r = sweep("sample_spacing", "voxels", {1.0 / 64, 1.0 / 60, 1.0 / 16, 1.0 / 4, 1, 2, 4},
                       [](Extreme& e, double s) { e.spacing = s * kVoxel; });
        !r)
      return r;
    touching();
    delay();
    breaking_points();
    facts_.more.emplace_back(
        "cases",
        fmt::format(
            "a cube on its corner, 3 mm deep in a plane, the force of the field alone (no spring), in closed "
            "form. An answer is lost when its force is off by {:.0f} % or more; samples cost some of it "
            "wherever arithmetic does not (same spacing for all three)",
            100 * kLost));
    facts_.more.emplace_back("left out",
                             "rotations other than one; round bodies (their tessellation hides rounding); "
                             "single precision on a device, which may round otherwise");
    console_.finish();
    return write_bench(options_.out, facts_, table_, charts());
  }

 private:
  void note(const std::string& name, const std::string& parameter, double value, const char* precision,
            const Outcome& outcome) {
    table_.rows.push_back({name, parameter, value, precision, outcome.error, outcome.text});
    seen_[name].push_back({parameter, value, precision, outcome});
  }

  Result<void> contact_case(const std::string& name, const std::string& parameter, double value,
                            const Extreme& extreme) {
    if (!console_.progress(name.c_str(), 0)) return Error{ErrorCode::kInternal, "interrupted"};
    const Scene3 scene = scene_of(extreme);
    const PlainAnswer single =
        plain_response<float>(scene.mockup, scene.tool, scene.pose, extreme.spacing * extreme.scale,
                              extreme.stiffness, scene.reference_area);
    const PlainAnswer twice =
        plain_response<double>(scene.mockup, scene.tool, scene.pose, extreme.spacing * extreme.scale,
                               extreme.stiffness, scene.reference_area);
    note(name, parameter, value, "fp32", judged(single.contact, single.force, scene.force));
    note(name, parameter, value, "fp64", judged(twice.contact, twice.force, scene.force));
    note(name, parameter, value, "palpate", by_palpate(scene, extreme));
    return {};
  }

  Outcome by_palpate(const Scene3& scene, const Extreme& extreme) {
    const auto refused = [](const Error& error) { return Outcome{0, "refused: " + error.sentence}; };
    GeometrySettings settings;
    settings.voxel_size_m = extreme.voxel * extreme.scale;
    settings.sample_spacing_m = extreme.spacing * extreme.scale;
    const Result<SceneGeometry> geometry = build_geometry(scene.mockup, scene.tool, settings);
    if (!geometry) return refused(geometry.error());
    if (auto done = backend_->prepare(*geometry, Plan{}, [](const char*, double) { return true; }); !done)
      return refused(done.error());
    const Result<LatticePose> pose = to_lattice(scene.pose, *geometry);
    if (!pose) return refused(pose.error());
    Contacts contacts;
    ContactResponse response;
    if (auto done = backend_->query(*pose, nullptr, contacts); !done) return refused(done.error());
    if (contacts.truncated) return {0, std::string("refused: too much for ") + contacts.truncated_capacity};
    respond(contacts, *pose, *geometry, Profile::kRefined, extreme.stiffness, response);
    return judged(contacts.contact, response.wrench.force, scene.force);
  }

  /// A flat face that comes as near as `gap` to another and stops: touching is contact, a gap is none. 200
  /// places each.
  void touching() {
    for (const double gap : {0.0, 1e-12, 1e-10, 1e-9, 1e-8, 1e-7, 1e-6}) {
      std::map<std::string, int> wrong;
      constexpr int kPlaces = 50;
      for (int i = 0; i < kPlaces; ++i)
        for (const double sign : {1.0, -1.0}) {
          if (gap == 0 && sign < 0) continue;
          Scene3 scene;
          const double half = 10 * kMm,
                       top = 0.1 + 0.0137 * i;  // the plane's height, no round number in binary
          scene.mockup =
              solids::box(Vec3(-20 * kMm, -20 * kMm, top - 20 * kMm), Vec3(20 * kMm, 20 * kMm, top));
          scene.tool = solids::box(Vec3(-half), Vec3(half));
          scene.pose.position = Vec3(0.617 * kMm, -0.331 * kMm, top + half + sign * gap);
          const bool truth = sign * gap <= 0;
          // What floating point can ask: whether the lowest vertex lies at or below the plane.
          const auto below = [&]<class Real>(Real) {
            const Real lowest = static_cast<Real>(-half) + static_cast<Real>(scene.pose.position.z);
            return lowest <= static_cast<Real>(top);
          };
          wrong["fp32"] += below(0.0f) != truth;
          wrong["fp64"] += below(0.0) != truth;
          GeometrySettings settings;
          settings.voxel_size_m = kVoxel;
          const Result<SceneGeometry> geometry = build_geometry(scene.mockup, scene.tool, settings);
          if (!geometry || !backend_->prepare(*geometry, Plan{}, [](const char*, double) { return true; })) {
            ++wrong["palpate"];
            continue;
          }
          Contacts contacts;
          const Result<LatticePose> pose = to_lattice(scene.pose, *geometry);
          if (!pose || !backend_->query(*pose, nullptr, contacts)) {
            ++wrong["palpate"];
            continue;
          }
          step_m_ = geometry->lattice.step_m;
          wrong["palpate"] += contacts.contact != truth;
          if (i % 10 == 0) console_.progress("touching", i / double{kPlaces});
        }
      const double tried = gap == 0 ? kPlaces : 2 * kPlaces;
      for (const char* precision : {"fp32", "fp64", "palpate"})
        note("touching", "gap or overlap, m", gap, precision,
             {wrong[precision] / tried, wrong[precision] == 0 ? "held" : "lost"});
    }
    facts_.more.emplace_back(
        "touching", fmt::format("the lattice step is {:.3g} m there: gaps below half of it are touch, by "
                                "definition (docs/EXACTNESS.md); the error is the share of wrong answers",
                                step_m_));
  }

  /// A hand that presses into a wall 5 m from the origin and out, results of all ages: the force felt against
  /// the one of the moment.
  void delay() {
    constexpr double kWall = 5, kDeep = 2e-3, kSeconds = 0.5;
    const auto depth_at = [&](double t) { return kDeep * std::sin(3.14159265358979 * t / kSeconds); };
    for (const int age : {1, 2, 5, 10, 20, 50, 100}) {
      double worst[3] = {0, 0, 0};
      const int ticks = static_cast<int>(kSeconds * 1000);
      ForceLawState law({.kind = LawKind::kCorrected, .stiffness_n_per_m = kStiffness, .transitions = 1});
      int of = -1;  // the tick whose pose the newest result is of
      for (int i = 0; i < ticks; ++i) {
        const double x = kWall - depth_at(i / 1000.0),
                     truth = kStiffness * std::max(0.0, depth_at(i / 1000.0));
        LawResult result;
        const bool fresh = i % age == 0 && i >= age;
        if (fresh) {
          of = i - age;
          const double then = depth_at(of / 1000.0);
          result.tick = of;
          result.gc = Vec3(kWall - then, 0, 0);
          if (then > 0) {
            result.contact = true;
            result.plane_count = 1;
            result.planes[0] = {Vec3(1, 0, 0), Vec3(0), kStiffness * then, kStiffness};
            result.wrench.force = Vec3(kStiffness * then, 0, 0);
          }
        }
        const Wrench felt = law.step({i, Vec3(x, 0, 0), Quat(1, 0, 0, 0)}, fresh ? &result : nullptr);
        if (of < 2 * age || i < 3 * age) continue;  // the first results of a touch come late for everybody
        const double then = kWall - depth_at(of / 1000.0);
        worst[0] =
            std::max(worst[0], std::fabs(plain_extrapolation<float>(kWall, then, x, kStiffness) - truth));
        worst[1] =
            std::max(worst[1], std::fabs(plain_extrapolation<double>(kWall, then, x, kStiffness) - truth));
        worst[2] = std::max(worst[2], std::fabs(felt.force.x - truth));
      }
      const char* names[] = {"fp32", "fp64", "palpate"};
      for (std::size_t k = 0; k < 3; ++k) {
        const double error = worst[k] / (kStiffness * kDeep);
        note("delay", "ticks", age, names[k], {error, error < kLost ? "held" : "lost"});
      }
    }
  }

  /// For each case and precision: the values at which an answer is lost or refused.
  void breaking_points() {
    for (const auto& [name, all] : seen_) {
      std::string text;
      for (const char* precision : {"fp32", "fp64", "palpate"}) {
        std::string lost, refused;
        for (const Seen& seen : all) {
          if (seen.precision != precision || seen.outcome.text == "held") continue;
          std::string& list = seen.outcome.text.starts_with("refused") ? refused : lost;
          list += fmt::format("{}{:.3g}", list.empty() ? "" : ", ", seen.value);
        }
        text += fmt::format("{}{}: {}", text.empty() ? "" : "; ", precision,
                            lost.empty() && refused.empty() ? "nowhere" : "");
        if (!lost.empty()) text += "lost at " + lost;
        if (!refused.empty()) text += (lost.empty() ? "" : ", ") + ("refused at " + refused);
      }
      facts_.more.emplace_back(fmt::format("breaks, {} ({})", name, all.front().parameter), text);
    }
  }

  std::vector<BenchChart> charts() const {
    std::vector<BenchChart> out;
    for (const auto& [name, all] : seen_) {
      BenchChart chart{.title = "Relative error of the force: " + name,
                       .unit = "",
                       .labels = {},
                       .series = {},
                       .log_x = true,
                       .log_y = true,
                       .x_title = all.front().parameter};
      // A colour a precision; circles where it held, crosses where it is lost, triangles at 100 % where it
      // refused.
      std::size_t ink = 0;
      for (const char* precision : {"fp32", "fp64", "palpate"}) {
        BenchChart::Series line{.label = precision, .x = {}, .y = {}};
        line.ink = ink;
        BenchChart::Series lost{.label = std::string(precision) + ", lost", .x = {}, .y = {}}, refused = lost;
        lost.ink = refused.ink = ink++;
        lost.line = refused.line = false;
        lost.marker = BenchChart::Marker::kCross;
        refused.label = std::string(precision) + ", refused";
        refused.marker = BenchChart::Marker::kTriangle;
        for (const Seen& seen : all) {
          if (seen.precision != precision || !(seen.value > 0)) continue;
          if (seen.outcome.text.starts_with("refused")) {
            refused.x.push_back(seen.value);
            refused.y.push_back(1);
            continue;
          }
          if (!(seen.outcome.error > 0) || !std::isfinite(seen.outcome.error)) continue;
          for (BenchChart::Series* series : {&line, &lost})
            if (series == &line || seen.outcome.text != "held") {
              series->x.push_back(seen.value);
              series->y.push_back(seen.outcome.error);
            }
        }
        chart.series.push_back(std::move(line));
        if (!lost.x.empty()) chart.series.push_back(std::move(lost));
        if (!refused.x.empty()) chart.series.push_back(std::move(refused));
      }
      chart.caption = fmt::format(
          "Circles: held. Crosses: lost, off by {:.0f} % or more, or nothing found. Triangles: refused, with "
          "a sentence. "
          "An error of 0 has no place on the axis.",
          100 * kLost);
      out.push_back(std::move(chart));
    }
    return out;
  }

  struct Seen {
    std::string parameter;
    double value = 0;
    std::string precision;
    Outcome outcome;
  };
  const BenchOptions& options_;
  const Parts& parts_;
  Console console_;
  std::unique_ptr<CollisionBackend> backend_;
  double step_m_ = 0;
  std::map<std::string, std::vector<Seen>> seen_;
  BenchFacts facts_{.command = "numerics", .device = {}, .more = {}};
  BenchTable table_{{"case", "parameter", "value", "precision", "error", "outcome"}, {}};
};

}  // namespace

Result<void> bench_numerics(const BenchOptions& options, const Parts& parts) {
  catch_interrupts();
  return NumericsBench(options, parts).run();
}

}  // namespace palpate

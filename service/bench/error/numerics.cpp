// `palpate bench numerics`: stiff and extreme cases, swept until something breaks: palpate beside the same
// method in plain single and double precision.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <map>

#include "model/contact/response.h"
#include "model/generate/solids.h"
#include "model/scene/geometry_build.h"
#include "service/bench/bench.h"
#include "service/bench/error/numerics_cases.h"
#include "service/bench/error/plain_response.h"
#include "service/bench/output.h"
#include "service/cli/console.h"
#include "service/cli/scene_host.h"
#include "service/loop/force_law.h"
#include "service/queries/lone_query.h"

namespace palpate {
namespace {

constexpr double kMm = 1e-3;
constexpr double kVoxel = 2 * kMm, kStiffness = 2000;
constexpr const char* kPrecisions[] = {"fp32", "fp64", "palpate"};
constexpr double kLost =
    0.05;  ///< of the force: beyond it an answer counts as broken (chosen: what a hand tells apart)

struct Outcome {
  double error = 0;  ///< |ΔF| over |F|, or a probability; HUGE_VAL: no contact found
  std::string text;  ///< "held", "lost", "no contact", or why it was refused
};

Outcome judged(bool contact, const Vec3& force, const NumericsScene& scene) {
  if (contact != scene.contact) return {1, contact ? "lost" : "no contact"};
  if (!contact) return {0, "held"};
  const double size = glm::length(scene.force);
  const double error =
      glm::length(force / size - scene.force / size);  // in this order: a square of 1e164 N is no number
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
        CornerExtreme extreme;
        set(extreme, value);
        if (auto done = contact_case(name, parameter, value, corner_scene(extreme)); !done) return done;
      }
      return {};
    };
    const auto made = [&](const char* name, const char* parameter, const std::vector<double>& values,
                          auto make) -> Result<void> {
      for (const double value : values)
        if (auto done = contact_case(name, parameter, value, make(value)); !done) return done;
      return {};
    };
    if (auto r = sweep("stiffness", "K, N/m", powers(-6, 42, 6),
                       [](CornerExtreme& e, double k) { e.stiffness = k; });
        !r)
      return r;
    if (auto r =
            sweep("scale", "factor", powers(-24, 12, 2), [](CornerExtreme& e, double s) { e.scale = s; });
        !r)
      return r;
    if (auto r = sweep("offset", "m from the origin", powers(-1, 13, 1),
                       [](CornerExtreme& e, double d) { e.offset = d; });
        !r)
      return r;
    if (auto r = sweep("aspect", "length over width of the triangles", {1, 4, 16, 64, 256, 1024, 4096},
                       [](CornerExtreme& e, double n) { e.strips = static_cast<int>(n); });
        !r)
      return r;
    if (auto r = sweep("depth", "voxels", {0.001, 0.01, 0.1, 0.3, 1, 3, 5},
                       [](CornerExtreme& e, double h) {
                         e.depth = h * kVoxel;
                         e.spacing = std::max(kVoxel / 60, std::min(e.spacing, e.depth / 12));
                       });
        !r)
      return r;
    if (auto r = sweep("sample_spacing", "voxels", {1.0 / 64, 1.0 / 60, 1.0 / 16, 1.0 / 4, 1, 2, 4},
                       [](CornerExtreme& e, double s) { e.spacing = s * kVoxel; });
        !r)
      return r;
    if (auto r = made("patch_aspect", "length over width of the patch", {1, 4, 16, 64, 256}, long_patch); !r)
      return r;
    if (auto r = made("patches", "separate patches", {1, 16, 144, 576},
                      [](double n) { return many_patches(static_cast<int>(std::lround(std::sqrt(n)))); });
        !r)
      return r;
    if (auto r = made("play_inside", "play over the part's size, in the middle", powers(-9, -2, 1),
                      [](double p) { return peg_with_play(p, false); });
        !r)
      return r;
    if (auto r = made("play_aside", "play over the part's size, pressed as deep", powers(-9, -2, 1),
                      [](double p) { return peg_with_play(p, true); });
        !r)
      return r;
    if (auto r = made("interference", "overlap over the part's size", powers(-9, -2, 1), tongue_pressed); !r)
      return r;
    if (auto r = stiffness_ratio(); !r) return r;
    touching();
    delay();
    if (auto r = ticks(); !r) return r;
    breaking_points();
    find_losses();
    facts_.more.emplace_back(
        "cases",
        fmt::format("stiffness to sample_spacing: a cube on its corner, 3 mm deep in a plane; patch_aspect: "
                    "a bar pressed "
                    "flat into a plane; patches: a plate on pads; play: a square peg in a square hole, in "
                    "its middle and "
                    "pressed aside; interference: a tongue between walls that it overlaps, off the middle; "
                    "stiffness_ratio: a standing bar, hung on the spring. The force is the field's alone but "
                    "for the last, "
                    "all in closed form. An answer is lost when its force is off by {:.0f} % or more; "
                    "samples cost some of "
                    "it wherever arithmetic does not (all samples, the same spacing for all three)",
                    100 * kLost));
    facts_.more.emplace_back("left out",
                             "rotations other than one; round bodies (their tessellation hides rounding); "
                             "single precision on a device, which may round otherwise");
    console_.finish();
    return write_bench(options_.out, facts_, table_, charts());
  }

 private:
  void note(const std::string& name, const std::string& parameter, double value, const char* precision,
            const Outcome& outcome, double length = -1) {
    table_.rows.push_back({name, parameter, value, precision, outcome.error, outcome.text});
    seen_[name].push_back({parameter, value, precision, outcome, length, step_m_});
  }

  Result<void> contact_case(const std::string& name, const std::string& parameter, double value,
                            const NumericsScene& scene) {
    if (name != step_name_) console_.step(step_name_ = name);
    if (!console_.progress(fmt::format("{} {:g}", parameter, value).c_str(), 0))
      return Error{ErrorCode::kInternal, "interrupted"};
    const PlainAnswer single = plainly<float>(scene, scene.pose), twice = plainly<double>(scene, scene.pose);
    if (interrupted()) return Error{ErrorCode::kInternal, "interrupted"};
    note(name, parameter, value, "fp32", judged(single.contact, single.force, scene));
    note(name, parameter, value, "fp64", judged(twice.contact, twice.force, scene));
    note(name, parameter, value, "palpate", by_palpate(scene), scene.length);
    return {};
  }

  template <class Real>
  static PlainAnswer plainly(const NumericsScene& scene, const Pose& pose) {
    return plain_response<Real>(scene.mockup, scene.tool, pose, scene.spacing, scene.stiffness,
                                scene.reference_area);
  }

  static Outcome refused(const Error& error) { return {0, "refused: " + error.sentence}; }

  /// `hung`: on the spring, as a lone query has it.
  Outcome by_palpate(const NumericsScene& scene, bool hung = false) {
    GeometrySettings settings;
    settings.voxel_size_m = scene.voxel;
    settings.sample_spacing_m = scene.spacing;
    settings.contact_samples = 0;  // all: as many as the others have
    const Result<SceneGeometry> geometry = build_geometry(scene.mockup, scene.tool, settings);
    if (!geometry) return refused(geometry.error());
    step_m_ = geometry->lattice.step_m;
    if (auto done = backend_->prepare(*geometry, Plan{}, [](const char*, double) { return true; }); !done)
      return refused(done.error());
    const Result<LatticePose> pose = to_lattice(scene.pose, *geometry);
    if (!pose) return refused(pose.error());
    Contacts contacts;
    ContactResponse response;
    if (auto done = backend_->query(*pose, nullptr, contacts); !done) return refused(done.error());
    if (contacts.truncated) return {0, std::string("refused: too much for ") + contacts.truncated_capacity};
    respond(contacts, *pose, *geometry, Profile::kRefined, scene.stiffness, response);
    if (hung) {
      LoneQuery lone(*geometry, scene.stiffness);
      if (auto done = lone.feel(*backend_, nullptr, scene.pose, response); !done)
        return refused(done.error());
    }
    return judged(contacts.contact, response.told().force, scene);
  }

  /// The place on the spring by bisection, each force in Real.
  template <class Real>
  static Outcome hung_plainly(const NumericsScene& scene) {
    const auto stiffness = static_cast<Real>(scene.stiffness), deep = static_cast<Real>(scene.length);
    Real low(0), high = deep, force(0);
    for (int i = 0; i < 40; ++i) {
      const Real u = (low + high) / Real(2);
      Pose pose = scene.pose;
      pose.position.z += static_cast<double>(deep - u);
      force = static_cast<Real>(plainly<Real>(scene, pose).force.z);
      (force < stiffness * (deep - u) ? low : high) = u;
    }
    return judged(true, Vec3(0, 0, static_cast<double>(stiffness * (deep - low))), scene);
  }

  Result<void> stiffness_ratio() {
    for (const double slimness : {1.0, 0.3, 0.1, 0.03, 0.01, 0.005}) {
      if (!console_.progress("stiffness_ratio", 0)) return Error{ErrorCode::kInternal, "interrupted"};
      const HungBar bar = hung_bar(slimness);
      const char *name = "stiffness_ratio", *parameter = "stiffness of the contact over the spring's";
      const Outcome single = hung_plainly<float>(bar.scene), twice = hung_plainly<double>(bar.scene);
      if (interrupted()) return Error{ErrorCode::kInternal, "interrupted"};
      note(name, parameter, bar.ratio, "fp32", single);
      note(name, parameter, bar.ratio, "fp64", twice);
      note(name, parameter, bar.ratio, "palpate", by_palpate(bar.scene, true), bar.scene.length);
    }
    return {};
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
          NumericsScene scene;
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
      for (const char* precision : kPrecisions)
        note("touching", "gap or overlap, m", gap, precision,
             {wrong[precision] / tried, wrong[precision] == 0 ? "held" : "lost"}, gap);
    }
    facts_.more.emplace_back(
        "touching",
        fmt::format("the lattice step is {:.3g} m there, to whose points corners are rounded: that "
                    "decides gaps and overlaps of a step and less; the error is the share of "
                    "wrong answers",
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
      for (std::size_t k = 0; k < 3; ++k) {
        const double error = worst[k] / (kStiffness * kDeep);
        note("delay", "ticks", age, kPrecisions[k], {error, error < kLost ? "held" : "lost"});
      }
    }
  }

  /// A hand that stays in a wall and goes in and out by 1 mm for hours of ticks: whether the law's answer
  /// wanders. Beside it its sum of steps (P = M − K Δx, then a third of the way to the newest result) in
  /// plain numbers.
  Result<void> ticks() {
    constexpr double kWall = 0.1, kDeep = 2e-3, kAge = 3;
    constexpr std::int64_t kTicks = 10'000'000;
    const auto place = [](std::int64_t i) {
      return kWall - kDeep - 1e-3 * std::sin(2 * 3.14159265358979 * static_cast<double>(i % 997) / 997);
    };
    ForceLawState law({.kind = LawKind::kCorrected, .stiffness_n_per_m = kStiffness, .transitions = 3});
    float single = 0;
    double twice = 0, worst[3] = {0, 0, 0};
    std::int64_t mark = 1000;
    for (std::int64_t i = 0; i <= kTicks; ++i) {
      const double x = place(i), truth = kStiffness * (kWall - x);
      const bool fresh = i % 3 == 0 && i >= 3;
      const double then = place(i - 3);
      LawResult result;
      if (fresh) {
        result.tick = i - 3;
        result.gc = Vec3(then, 0, 0);
        result.contact = true;
        result.plane_count = 1;
        result.planes[0] = {Vec3(1, 0, 0), Vec3(0), kStiffness * (kWall - then), kStiffness};
        result.wrench.force = Vec3(kStiffness * (kWall - then), 0, 0);
      }
      const Wrench felt = law.step({i, Vec3(x, 0, 0), Quat(1, 0, 0, 0)}, fresh ? &result : nullptr);
      const auto add = [&]<class Real>(Real& sum) {
        const Real k = static_cast<Real>(kStiffness);
        sum -= k * (static_cast<Real>(x) - static_cast<Real>(i > 0 ? place(i - 1) : x));
        if (fresh)
          sum += (k * (static_cast<Real>(kWall) - static_cast<Real>(then)) -
                  k * (static_cast<Real>(x) - static_cast<Real>(then)) - sum) /
                 static_cast<Real>(kAge);
      };
      add(single);
      add(twice);
      if (i < 500) continue;  // until the first results are in
      worst[0] = std::max(worst[0], std::fabs(static_cast<double>(single) - truth));
      worst[1] = std::max(worst[1], std::fabs(twice - truth));
      worst[2] = std::max(worst[2], std::fabs(felt.force.x - truth));
      if (i != mark) continue;
      for (std::size_t k = 0; k < 3; ++k) {
        const double error = worst[k] / (kStiffness * kDeep);
        note("ticks", "ticks of the law", static_cast<double>(i), kPrecisions[k],
             {error, error < kLost ? "held" : "lost"});
        worst[k] = 0;
      }
      mark *= 10;
      if (!console_.progress("ticks", static_cast<double>(i) / kTicks))
        return Error{ErrorCode::kInternal, "interrupted"};
    }
    return {};
  }

  /// Where palpate loses what fp64 holds, and why. A length that is short in steps of the lattice is rounded
  /// by up to a step, which costs kLost below 1 / kLost of them.
  void find_losses() {
    std::size_t losses = 0, unexplained = 0, refusals = 0;
    for (const auto& [name, all] : seen_)
      for (const Seen& seen : all) {
        if (seen.precision != "palpate" || seen.outcome.text == "held") continue;
        const bool held = std::any_of(all.begin(), all.end(), [&](const Seen& other) {
          return other.precision == "fp64" && other.value == seen.value && other.outcome.text == "held";
        });
        if (!held) continue;
        if (seen.outcome.text.starts_with("refused")) {
          ++refusals;
          continue;
        }
        ++losses;
        const double steps = seen.step_m > 0 ? seen.length / seen.step_m : 0;
        const bool explained = seen.step_m > 0 && seen.length >= 0 && steps < 1 / kLost;
        if (!explained) ++unexplained;
        facts_.findings.emplace_back(
            "",
            fmt::format("{} at {} {:.3g}: palpate loses what fp64 holds{}.", name, seen.parameter, seen.value,
                        explained ? fmt::format(": what decides is {:.3g} m, {:.2g} steps of the lattice, to "
                                                "whose points corners are rounded",
                                                seen.length, steps)
                                  : std::string(", for no reason that this bench knows")));
      }
    facts_.findings.insert(
        facts_.findings.begin(),
        {"", fmt::format(
                 "Of {} answers that fp64 holds palpate loses {}, {} of them without a stated reason, and "
                 "refuses {}, in a sentence.",
                 held_by("fp64"), losses, unexplained, refusals)});
    facts_.more.emplace_back("lost without a reason", fmt::format("{}", unexplained));
  }

  std::size_t held_by(const std::string& precision) const {
    std::size_t out = 0;
    for (const auto& [name, all] : seen_)
      for (const Seen& seen : all)
        if (seen.precision == precision && seen.outcome.text == "held") ++out;
    return out;
  }

  /// For each case and precision: the values at which an answer is lost or refused.
  void breaking_points() {
    for (const auto& [name, all] : seen_) {
      std::string text;
      for (const char* precision : kPrecisions) {
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

  std::vector<Chart> charts() const {
    std::vector<Chart> out;
    for (const auto& [name, all] : seen_) {
      std::string words = name;
      std::ranges::replace(words, '_', ' ');
      Chart chart{
          .title =
              (name == "touching" ? "Share of wrong answers: " : "Relative error of the force: ") + words,
          .unit = "",
          .labels = {},
          .series = {},
          .log_x = true,
          .log_y = true,
          .x_title = all.front().parameter};
      // A colour a precision; circles where it held, crosses where it is lost, triangles at 100 % where it
      // refused.
      std::size_t ink = 0;
      for (const char* precision : kPrecisions) {
        Chart::Series line{.label = precision, .x = {}, .y = {}};
        line.ink = ink;
        Chart::Series lost{.label = std::string(precision) + ", lost", .x = {}, .y = {}}, refused = lost;
        lost.ink = refused.ink = ink++;
        lost.line = refused.line = false;
        lost.marker = Chart::Marker::kCross;
        refused.label = std::string(precision) + ", refused";
        refused.marker = Chart::Marker::kTriangle;
        for (const Seen& seen : all) {
          if (seen.precision != precision || !(seen.value > 0)) continue;
          if (seen.outcome.text.starts_with("refused")) {
            refused.x.push_back(seen.value);
            refused.y.push_back(1);
            continue;
          }
          if (!(seen.outcome.error > 0) || !std::isfinite(seen.outcome.error)) continue;
          for (Chart::Series* series : {&line, &lost})
            if (series == &line || seen.outcome.text != "held") {
              series->x.push_back(seen.value);
              series->y.push_back(seen.outcome.error);
            }
        }
        chart.series.push_back(std::move(line));
        if (!lost.x.empty()) chart.series.push_back(lost);
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
    double length = -1,
           step_m = 0;  ///< m: what decides, where that is short; below 0: none; the lattice's step
  };
  const BenchOptions& options_;
  const Parts& parts_;
  Console console_;
  std::string step_name_;  ///< of the case at hand
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

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <filesystem>

#include "driver/haptic_device.h"
#include "service/bench/bench.h"
#include "service/bench/output.h"
#include "service/bench/stability/stability_bodies.h"
#include "service/bench/stability/stability_contacts.h"
#include "service/cli/console.h"
#include "service/cli/scene_host.h"
#include "service/loop/session.h"

namespace palpate {
namespace {

constexpr double kLow = 10, kHigh = 20000;  // N/m: where K is looked for
constexpr int kTicks = 20000;

Error cut_short() { return {ErrorCode::kInternal, "interrupted"}; }

const char* name_of(LawKind kind) {
  return kind == LawKind::kHold ? "hold" : kind == LawKind::kPrinted ? "printed" : "corrected";
}

/// One cell: everything that the highest stable K depends on.
struct Cell {
  LawKind law = LawKind::kCorrected;
  int delay = 1, n = 1;
  double mass = 0.5, damping = 1, hand_damping = 0;
  std::uint32_t areas = 1;
  Delivery::Kind delivery = Delivery::Kind::kFixed;
  bool pushes_only = false;  ///< bounces on the wall, instead of being pressed deep into it
};

AxisLoop loop_of(const Cell& cell, double k) {
  AxisLoop loop;
  loop.mass_kg = cell.mass;
  loop.damping = cell.damping;
  loop.hand_damping = cell.hand_damping;
  loop.delivery = {.kind = cell.delivery, .delay = cell.delay};
  loop.law = {.kind = cell.law, .stiffness_n_per_m = k, .transitions = cell.n, .change_n_per_s = 100};
  if (cell.pushes_only) {
    loop.contact = linear_wall(k, 0, cell.areas);
    loop.load_n = -1;
    loop.reach_m = 0.1 + 4 / k;  // a soft wall is deep
    loop.start_x = 1e-3;
    loop.settle_ticks = 0;
  } else {
    constexpr double kLoad = 10;  // N; shakes of a micrometre never come out of the wall
    loop.contact = linear_wall(k, kLoad / k, cell.areas, 1, false);
    loop.load_n = -kLoad;
  }
  return loop;
}

/// Below this much motion nothing is left but rounding (pressed) or what no hand feels (bouncing), m.
double least(const Cell& cell) { return cell.pushes_only ? 1e-6 : 1e-12; }

double critical(const Cell& cell) {
  return highest_stable(
      kLow, kHigh, [&](double k) { return AxisLoop::stable(loop_of(cell, k).run(kTicks), least(cell)); });
}

/// The linear limit (b + B) / (T/2 + t): t is the time by which the force lags the hand. Held: a result is c
/// ticks old when it comes and 2c − 1 when it goes. Printed, n = c: a tick's motion is lost at each result
/// and made good over c ticks. Corrected: none.
double theory(const Cell& cell) {
  if (cell.law == LawKind::kPrinted && cell.n != cell.delay) return std::nan("");
  const double c = cell.delay;
  const double lag = cell.law == LawKind::kHold      ? (1.5 * c - 0.5) * kTickSeconds
                     : cell.law == LawKind::kPrinted ? (c - 1) / (2 * c) * kTickSeconds
                                                     : 0;
  return (cell.damping + cell.hand_damping) / (0.5 * kTickSeconds + lag);
}

void add_cell(BenchTable& table, const std::string& model, const Cell& cell, double critical_k,
              double theory_k) {
  table.rows.push_back({std::string(name_of(cell.law)), model, std::uint64_t(cell.delay),
                        std::uint64_t(cell.n), cell.mass, cell.damping, cell.hand_damping,
                        std::uint64_t{cell.areas}, critical_k,
                        std::isfinite(theory_k) ? BenchCell(theory_k) : BenchCell(std::string())});
}

/// A law has one colour in all charts.
std::size_t ink_of(LawKind law) { return static_cast<std::size_t>(law); }

Chart lines(std::string title, std::string x_title, std::string unit, bool log_x, bool log_y) {
  Chart chart;
  chart.title = std::move(title);
  chart.x_title = std::move(x_title);
  chart.unit = std::move(unit);
  chart.log_x = log_x;
  chart.log_y = log_y;
  return chart;
}

constexpr LawKind kLaws[] = {LawKind::kHold, LawKind::kPrinted, LawKind::kCorrected};

/// Table and curves: one thing changed at a time.
Result<void> measure_formulas(Console& console, BenchTable& table, std::vector<Chart>& charts) {
  const auto sweep = [&](const std::string& model, const char* x_title, const std::vector<double>& values,
                         auto set) {
    if (interrupted()) return;
    console.step("formulas: " + model);
    const double all = static_cast<double>(std::size(kLaws) * values.size());
    double done = 0;
    Chart chart = lines("Highest stable K, " + model, x_title, "N/m", true, true);
    chart.caption = fmt::format(
        "hold: a result is kept until the next; printed: the law as the chapter has it; corrected: "
        "ours. Linear: pressed deep into the wall; unilateral: bouncing on it. Theory is drawn where "
        "there is one, of the printed law for n = c alone. A point at {:g} N/m: nothing above it was "
        "stable, and nothing below it was tried.",
        kLow);
    for (const LawKind law : kLaws) {
      Chart::Series series{.label = name_of(law), .x = {}, .y = {}, .ink = ink_of(law)},
          expected{.label = std::string(name_of(law)) + ", theory",
                   .x = {},
                   .y = {},
                   .expected = true,
                   .ink = ink_of(law)};
      for (const double value : values) {
        if (!console.progress("the highest stable K", done++ / all)) return;
        Cell cell{.law = law};
        set(cell, value);
        const double k = critical(cell), known = cell.pushes_only ? std::nan("") : theory(cell);
        add_cell(table, model, cell, k, known);
        series.x.push_back(value), series.y.push_back(k);
        if (std::isfinite(known)) expected.x.push_back(value), expected.y.push_back(known);
      }
      chart.series.push_back(std::move(series));
      if (!expected.x.empty()) chart.series.push_back(std::move(expected));
    }
    charts.push_back(std::move(chart));
  };
  const std::vector<double> delays{1, 2, 3, 5, 10, 20, 50};
  sweep("linear", "age of results c, ticks (n = c)", delays,
        [](Cell& cell, double c) { cell.delay = cell.n = static_cast<int>(c); });
  sweep("unilateral", "age of results c, ticks (n = c)", delays, [](Cell& cell, double c) {
    cell.delay = cell.n = static_cast<int>(c);
    cell.pushes_only = true;
  });
  sweep("linear, 10 ms", "n, ticks", {1, 3, 5, 10, 20, 50},
        [](Cell& cell, double n) { cell.delay = 10, cell.n = static_cast<int>(n); });
  sweep("linear, 5 ms, mass", "kg", {0.02, 0.05, 0.2, 0.5, 2, 5},
        [](Cell& cell, double m) { cell.delay = cell.n = 5, cell.mass = m; });
  sweep("linear, 5 ms, damping", "N·s/m", {0.1, 0.3, 1, 3, 10},
        [](Cell& cell, double b) { cell.delay = cell.n = 5, cell.damping = b; });
  sweep("linear, 5 ms, hand", "N·s/m", {0.1, 1, 3, 6.5},
        [](Cell& cell, double b) { cell.delay = cell.n = 5, cell.hand_damping = b; });
  sweep("linear, 5 ms, areas", "areas", {1, 2, 4, 8},
        [](Cell& cell, double a) { cell.delay = cell.n = 5, cell.areas = static_cast<std::uint32_t>(a); });
  for (const auto& [kind, model] : {std::pair{Delivery::Kind::kRandom, "unilateral, random delay"},
                                    {Delivery::Kind::kBursty, "unilateral, bursts"},
                                    {Delivery::Kind::kLost, "unilateral, one in four lost"}})
    sweep(model, "mean age c, ticks (n = c)", {2, 5, 10}, [kind = kind](Cell& cell, double c) {
      cell.delay = cell.n = static_cast<int>(c);
      cell.delivery = kind;
      cell.pushes_only = true;
    });
  if (interrupted()) return cut_short();
  return {};
}

/// Two things changed at a time: age of the results against n, and against the mass.
Result<void> measure_maps(Console& console, BenchTable& table, std::vector<Chart>& charts) {
  const std::vector<int> delays{1, 2, 5, 10, 20, 50};
  const auto map = [&](const std::string& model, LawKind law, const char* y_title,
                       const std::vector<double>& values, auto set) {
    if (interrupted()) return;
    console.step(fmt::format("map: {}, {}", model, name_of(law)));
    const double all = static_cast<double>(values.size() * delays.size());
    double done = 0;
    Chart chart = lines(fmt::format("Highest stable K, {}, {} ({:g}: at most)", model, name_of(law), kLow),
                        "age of results c, ticks", "N/m", false, false);
    chart.map = true;
    chart.map_low = kLow,
    chart.map_high = kHigh;  // the same for all, so that they can be held beside each other
    chart.y_title = y_title;
    for (const int delay : delays) chart.labels.push_back(std::to_string(delay));
    for (const double value : values) {
      Chart::Series row{fmt::format("{:g}", value), {}, {}};
      for (const int delay : delays) {
        if (!console.progress("the highest stable K", done++ / all)) return;
        Cell cell{.law = law, .delay = delay, .n = delay};
        set(cell, value);
        row.y.push_back(critical(cell));
        add_cell(table, model, cell, row.y.back(),
                 cell.pushes_only || cell.n != cell.delay ? std::nan("") : theory(cell));
      }
      chart.series.push_back(std::move(row));
    }
    charts.push_back(std::move(chart));
  };
  for (const LawKind law : {LawKind::kPrinted, LawKind::kCorrected}) {
    map("linear", law, "n, ticks", {1, 2, 5, 10, 20, 50},
        [](Cell& cell, double n) { cell.n = static_cast<int>(n); });
    map("unilateral", law, "mass, kg (n = c)", {0.02, 0.05, 0.2, 0.5, 2, 5},
        [](Cell& cell, double m) { cell.mass = m, cell.pushes_only = true; });
  }
  if (interrupted()) return cut_short();
  return {};
}

SimulatedMaker simulated(const Parts& parts) {
  return [&parts](const DeviceSettings& device, const Pose& start) {
    Scene scene;
    scene.device = device;
    scene.start = start;
    return parts.make_device("simulated", scene, Vec3(0), {});
  };
}

/// The native engine answers `refined` alone; the reference answers the chapter's profile, too, but takes its
/// time.
BackendMaker engine_of(const Parts& parts, Profile profile) {
  if (profile == Profile::kPaper) return parts.make_ref;
  return [&parts] { return parts.make_cpu(false); };
}

/// The real collision query in the loop, a whole tool behind the spring that goes with it: results 10 ticks
/// old against none.
Result<void> measure_queries(const Parts& parts, Console& console, BenchTable& table, Chart& chart) {
  const SimulatedMaker make = simulated(parts);
  for (const LawKind law : kLaws)
    chart.series.push_back({.label = name_of(law), .x = {}, .y = {}, .ink = ink_of(law)});
  chart.series.push_back({"no delay", {}, {}});
  for (const ContactCase& what : pressed_contacts()) {
    console.step("closing the loop over " + what.name);
    auto prepared = PreparedCase::make(what, Profile::kRefined, engine_of(parts, Profile::kRefined));
    if (!prepared) return prepared.error();
    const auto none =
        highest_stable_body_query(make, what, **prepared, bare_device(), LawKind::kCorrected, 0, interrupted);
    if (!none) return none.error();
    chart.labels.push_back(what.name);
    const std::uint32_t areas = what.name == "four" ? 4 : 1;
    add_cell(table, "query: " + what.name, {.law = LawKind::kCorrected, .delay = 0, .areas = areas}, *none,
             *none);
    for (std::size_t i = 0; i < 3; ++i) {
      if (!console.progress("the highest stable K", 0.25 * static_cast<double>(i + 1))) return cut_short();
      const auto k =
          highest_stable_body_query(make, what, **prepared, bare_device(), kLaws[i], 10, interrupted);
      if (!k) return k.error();
      add_cell(table, "query: " + what.name, {.law = kLaws[i], .delay = 10, .n = 10, .areas = areas}, *k,
               *none);
      chart.series[i].y.push_back(*k);
    }
    chart.series[3].y.push_back(*none);
  }
  return {};
}

/// A whole tool in six degrees of freedom, its contact a formula; then the real query, held by a hand.
Result<void> measure_bodies(const Parts& parts, Console& console, BenchTable& table, Chart& chart) {
  const SimulatedMaker make = simulated(parts);
  const auto row = [&](const std::string& model, LawKind law, int delay, const DeviceSettings& device,
                       std::size_t areas, double found, double expected) {
    Cell cell{
        .law = law, .delay = delay, .n = std::max(delay, 1), .areas = static_cast<std::uint32_t>(areas)};
    cell.mass = device.mass_kg + device.hand_mass_kg, cell.damping = device.damping_n_s_per_m,
    cell.hand_damping = device.hand_damping_n_s_per_m;
    add_cell(table, model, cell, found, expected);
  };
  for (const LawKind law : kLaws)
    chart.series.push_back({.label = name_of(law), .x = {}, .y = {}, .ink = ink_of(law)});
  chart.series.push_back({"theory without delay", {}, {}});
  for (const BodyCase& what : body_cases()) {
    console.step("six degrees of freedom: " + what.name);
    chart.labels.push_back(what.name);
    const double all = 3 * std::size(kLaws);  // three delays
    double done = 0;
    for (const int delay : {1, 5, 10})
      for (std::size_t i = 0; i < 3; ++i) {
        if (!console.progress("the highest stable K", done++ / all)) return cut_short();
        const double k = highest_stable_body(make, what, kLaws[i], delay);
        // The printed law pulls by a scalar K along every way, so no limit of one contact is its own.
        const double expected =
            kLaws[i] == LawKind::kPrinted
                ? std::nan("")
                : body_theory(what.device, what.pads,
                              kLaws[i] == LawKind::kHold ? (1.5 * delay - 0.5) * kTickSeconds : 0);
        row("body: " + what.name, kLaws[i], delay, what.device, what.pads.size(), k, expected);
        if (delay == 10) chart.series[i].y.push_back(k);
      }
    chart.series[3].y.push_back(body_theory(what.device, what.pads, 0));
  }
  const BodyCase plate = body_cases().front();
  for (const int delay : {1, 5, 10})
    for (const LawKind law : kLaws) {
      if (interrupted()) return cut_short();
      row("body: plate, dropped", law, delay, plate.device, plate.pads.size(),
          highest_stable_body(make, plate, law, delay, true), std::nan(""));
    }
  const double limit = 4 * body_theory(plate.device, plate.pads, 0);
  for (const double spring : {1800.0, 3000.0, 4000.0, 10000.0}) {
    if (interrupted()) return cut_short();
    const double k = highest_stable_body(make, plate, LawKind::kCorrected, 10, false, {spring, 8});
    row(fmt::format("body: plate, virtual coupling of {:.0f} N/m", spring), LawKind::kCorrected, 10,
        plate.device, plate.pads.size(), k,
        spring > limit ? limit * spring / (spring - limit) / 4 : std::nan(""));
  }
  for (const ContactCase& what : pressed_contacts()) {
    if (what.name != "flat" && what.name != "four" && what.name != "peg") continue;
    auto prepared = PreparedCase::make(what, Profile::kRefined, engine_of(parts, Profile::kRefined));
    if (!prepared) return prepared.error();
    console.step("six degrees of freedom over the query, held by a hand: " + what.name);
    const auto k = highest_stable_body_query(make, what, **prepared, DeviceSettings{}, LawKind::kCorrected,
                                             10, interrupted);
    if (!k) return k.error();
    row("body over the query, held by a hand: " + what.name, LawKind::kCorrected, 10, DeviceSettings{},
        what.name == "four" ? 4 : 1, *k, std::nan(""));
  }
  return {};
}

/// What a session sends, from tick to tick.
class StepWatch : public RunObserver {
 public:
  Result<void> on_tick(const TickRecord& tick) override {
    const Wrench step{tick.sent.force - before_.force, tick.sent.torque - before_.torque};
    force = std::max(force, glm::length(step.force));
    torque = std::max(torque, glm::length(step.torque));
    const Vec3 bend = step.force - step_.force;
    sum_ += glm::dot(bend, bend);
    before_ = tick.sent;
    step_ = step;
    ++ticks_;
    return {};
  }
  double jerk() const { return std::sqrt(sum_ / std::max(ticks_, 1)); }
  double force = 0, torque = 0;  ///< largest step in a tick, N and N·m

 private:
  Wrench before_, step_;
  double sum_ = 0;
  int ticks_ = 0;
};

/// Whole scenes in virtual time, with their device, hand and limits: the chapter's profile and law, then as
/// the scene says.
Result<void> measure_scenes(const BenchOptions& options, const Parts& parts, Console& console,
                            BenchFacts& facts, Chart& force, Chart& torque) {
  for (const std::string& file : options.scenes) {
    StepWatch watch[2];
    for (const bool own : {false, true}) {
      SceneOptions common;
      common.scene = file;
      common.backend = own ? "cpu" : "ref";
      if (!own) common.profile = Profile::kPaper;
      Result<std::unique_ptr<HostedScene>> prepared =
          prepare_scene(common, Purpose::kSession, parts, console);
      if (!prepared) return prepared.error();
      LoadedScene& loaded = (*prepared)->loaded;
      if (!own) loaded.scene.control.law = ForceLaw::kPrinted;
      auto device = parts.make_device("simulated", loaded.scene, loaded.geometry.tool_gc_m, {});
      if (!device) return device.error();
      console.step(fmt::format("{}, {}", file, own ? "as it is" : "the chapter's method"));
      const auto summary = run_session(loaded, *(*prepared)->backend, **device,
                                       {.pace = Pace::kAsap, .stop = &interrupt_flag()}, &watch[own]);
      if (!summary) return summary.error();
      if (summary->failure) return *summary->failure;
      if (summary->stopped) return cut_short();
      force.series[own].y.push_back(watch[own].force);
      torque.series[own].y.push_back(watch[own].torque);
    }
    const std::string name = std::filesystem::path(file).stem().string();
    force.labels.push_back(name), torque.labels.push_back(name);
    facts.more.emplace_back("session, " + name,
                            fmt::format("largest step a tick {:.3f} N and {:.1f} mN·m (chapter {:.3f} and "
                                        "{:.1f}), rms jerk {:.3f} N a tick² ({:.3f})",
                                        watch[1].force, 1e3 * watch[1].torque, watch[0].force,
                                        1e3 * watch[0].torque, watch[1].jerk(), watch[0].jerk()));
  }
  return {};
}

/// Largest step of force and torque, the chapter's method beside the default.
Result<void> measure_jumps(const Parts& parts, Console& console, BenchFacts& facts, Chart& force,
                           Chart& torque) {
  force.series = {{"chapter", {}, {}}, {"default", {}, {}}};
  torque.series = force.series;
  constexpr int kDelay = 5;
  for (const ContactCase& what : jumping_motions()) {
    console.step("jumps: " + what.name);
    JumpStatistics found[2];
    for (const bool refined : {false, true}) {
      if (interrupted()) return cut_short();
      const Profile profile = refined ? Profile::kRefined : Profile::kPaper;
      auto prepared = PreparedCase::make(what, profile, engine_of(parts, profile));
      if (!prepared) return prepared.error();
      const ForceLawSettings law{.kind = refined ? LawKind::kCorrected : LawKind::kPrinted,
                                 .stiffness_n_per_m = 2000,
                                 .transitions = kDelay,
                                 .change_n_per_s = 100};
      const auto statistics = jumps(what, **prepared, law, kDelay);
      if (!statistics) return statistics.error();
      found[refined] = *statistics;
      force.series[refined].y.push_back(statistics->force_step_n);
      torque.series[refined].y.push_back(statistics->torque_step_nm);
    }
    force.labels.push_back(what.name);
    torque.labels.push_back(what.name);
    facts.more.emplace_back(
        "jumps, " + what.name,
        fmt::format("largest step a tick {:.3f} N and {:.3f} mN·m (chapter {:.3f} and {:.3f}), rms jerk "
                    "{:.3f} N and {:.3f} mN·m a tick² ({:.3f} and {:.3f}), "
                    "least push {:.2f} N ({:.2f}), results step by up to {:.1f} N ({:.1f})",
                    found[1].force_step_n, 1e3 * found[1].torque_step_nm, found[0].force_step_n,
                    1e3 * found[0].torque_step_nm, found[1].force_jerk, 1e3 * found[1].torque_jerk,
                    found[0].force_jerk, 1e3 * found[0].torque_jerk, found[1].least_push_n,
                    found[0].least_push_n, found[1].response_step_n, found[0].response_step_n));
  }
  return {};
}

/// What a wall gives to a hand that bounces on it.
void measure_energy(BenchTable&, BenchFacts& facts) {
  for (const int delay : {1, 5, 10, 20})
    for (const LawKind law : kLaws) {
      const Cell cell{.law = law, .delay = delay, .n = delay, .pushes_only = true};
      const AxisLoop::Outcome outcome = loop_of(cell, 500).run(kTicks);
      facts.more.emplace_back(
          fmt::format("energy, {} {} ms", name_of(law), delay),
          fmt::format("{:.2f} mJ given out, least force {:.2f} N, largest step {:.2f} N (500 N/m, 0.5 kg, 1 "
                      "N·s/m, dropped from 1 mm by 1 N)",
                      outcome.energy_out_j * 1e3, outcome.least_force_n, outcome.largest_step_n));
    }
}

}  // namespace

Result<void> bench_stability(const BenchOptions& options, const Parts& parts) {
  catch_interrupts();
  Console console;
  BenchFacts facts{.command = "stability",
                   .device = "cpu (profile refined) and ref (paper) on the processor, in virtual time",
                   .more = {}};
  BenchTable table{{"law", "stiffness_model", "delay_ticks", "n", "mass_kg", "damping", "hand_damping",
                    "areas", "critical_k", "theory_k"},
                   {}};
  std::vector<Chart> charts;
  if (auto done = measure_formulas(console, table, charts); !done) return done;
  if (auto done = measure_maps(console, table, charts); !done) return done;
  Chart queries =
      lines("Highest stable K over the real collision query, results 10 ms old", "", "N/m", false, true);
  if (auto done = measure_queries(parts, console, table, queries); !done) return done;
  Chart bodies = lines("Highest stable K of a tool in six degrees of freedom, results 10 ms old", "", "N/m",
                       false, true);
  if (auto done = measure_bodies(parts, console, table, bodies); !done) return done;
  Chart force = lines("Largest step of the force between two ticks", "", "N", false, true),
        torque = lines("Largest step of the torque between two ticks", "", "N·m", false, true);
  if (auto done = measure_jumps(parts, console, facts, force, torque); !done) return done;
  if (auto done = measure_scenes(options, parts, console, facts, force, torque); !done) return done;
  measure_energy(table, facts);
  charts.insert(charts.end(), {queries, bodies, force, torque});
  for (const auto& [what, text] : facts.more) console.note(what + ": " + text);
  console.finish();
  return write_bench(options.out, facts, table, charts);
}

}  // namespace palpate

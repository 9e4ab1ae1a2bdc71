#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "service/cli_bench.h"
#include "service/cli_bench_output.h"
#include "service/console.h"
#include "service/stability_contacts.h"

namespace palpate {
namespace {

constexpr double kTick = 1e-3;               // s
constexpr double kLow = 10, kHigh = 20000;   // N/m: where K is looked for
constexpr int kTicks = 20000;

const char* name_of(LawKind kind) { return kind == LawKind::kHold ? "hold" : kind == LawKind::kPrinted ? "printed" : "corrected"; }

/// One cell: everything that the highest stable K depends on.
struct Cell {
  LawKind law = LawKind::kCorrected;
  int delay = 1, n = 1;
  double mass = 0.5, damping = 1, hand_damping = 0;
  std::uint32_t areas = 1;
  Delivery::Kind delivery = Delivery::Kind::kFixed;
  bool pushes_only = false;   ///< bounces on the wall, instead of being pressed deep into it
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
    loop.start_x = 1e-3;
    loop.settle_ticks = 0;
  } else {
    constexpr double kLoad = 10;   // N; shakes of a micrometre never come out of the wall
    loop.contact = linear_wall(k, kLoad / k, cell.areas, 1, false);
    loop.load_n = -kLoad;
  }
  return loop;
}

/// Below this much motion nothing is left but rounding (pressed) or what no hand feels (bouncing), m.
double least(const Cell& cell) { return cell.pushes_only ? 1e-6 : 1e-12; }

double critical(const Cell& cell) {
  return highest_stable(kLow, kHigh, [&](double k) { return AxisLoop::stable(loop_of(cell, k).run(kTicks), least(cell)); });
}

/// The linear limit (b + B) / (T/2 + t): t is the time by which the force lags the hand. Held: a result is c ticks old when it comes and
/// 2c − 1 when it goes. Printed, n = c: a tick's motion is lost at each result and made good over c ticks. Corrected: none.
double theory(const Cell& cell) {
  const double c = cell.delay;
  const double lag = cell.law == LawKind::kHold ? (1.5 * c - 0.5) * kTick : cell.law == LawKind::kPrinted ? (c - 1) / (2 * c) * kTick : 0;
  return (cell.damping + cell.hand_damping) / (0.5 * kTick + lag);
}

void add_cell(BenchTable& table, const std::string& model, const Cell& cell, double critical_k, double theory_k) {
  table.rows.push_back({std::string(name_of(cell.law)), model, std::uint64_t(cell.delay), std::uint64_t(cell.n), cell.mass, cell.damping,
                        cell.hand_damping, std::uint64_t{cell.areas}, critical_k, std::isfinite(theory_k) ? BenchCell(theory_k) : BenchCell(std::string())});
}

using Chart = BenchChart;

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

/// The design's table and the maps round it: one thing changed at a time.
void measure_formulas(Console& console, BenchTable& table, std::vector<Chart>& charts) {
  const auto sweep = [&](const std::string& model, const char* x_title, const std::vector<double>& values, auto set) {
    Chart chart = lines("Highest stable K, " + model, x_title, "N/m", true, true);
    for (const LawKind law : kLaws) {
      Chart::Series series{name_of(law), {}, {}}, expected{std::string(name_of(law)) + ", theory", {}, {}};
      for (const double value : values) {
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
    console.step(model);
  };
  const std::vector<double> delays{1, 2, 3, 5, 10, 20, 50};
  sweep("linear", "age of results c, ticks (n = c)", delays, [](Cell& cell, double c) { cell.delay = cell.n = static_cast<int>(c); });
  sweep("unilateral", "age of results c, ticks (n = c)", delays, [](Cell& cell, double c) {
    cell.delay = cell.n = static_cast<int>(c);
    cell.pushes_only = true;
  });
  sweep("linear, 10 ms", "n, ticks", {1, 3, 5, 10, 20, 50}, [](Cell& cell, double n) { cell.delay = 10, cell.n = static_cast<int>(n); });
  sweep("linear, 5 ms, mass", "kg", {0.02, 0.05, 0.2, 0.5, 2, 5}, [](Cell& cell, double m) { cell.delay = cell.n = 5, cell.mass = m; });
  sweep("linear, 5 ms, damping", "N·s/m", {0.1, 0.3, 1, 3, 10}, [](Cell& cell, double b) { cell.delay = cell.n = 5, cell.damping = b; });
  sweep("linear, 5 ms, hand", "N·s/m", {0.1, 1, 3, 6.5}, [](Cell& cell, double b) { cell.delay = cell.n = 5, cell.hand_damping = b; });
  sweep("linear, 5 ms, areas", "areas", {1, 2, 4, 8}, [](Cell& cell, double a) { cell.delay = cell.n = 5, cell.areas = static_cast<std::uint32_t>(a); });
  for (const auto& [kind, model] : {std::pair{Delivery::Kind::kRandom, "unilateral, random delay"}, {Delivery::Kind::kBursty, "unilateral, bursts"},
                                    {Delivery::Kind::kLost, "unilateral, one in four lost"}})
    sweep(model, "mean age c, ticks (n = c)", {2, 5, 10}, [kind = kind](Cell& cell, double c) {
      cell.delay = cell.n = static_cast<int>(c);
      cell.delivery = kind;
      cell.pushes_only = true;
    });
}

/// The real collision query in the loop: results 10 ticks old against none.
Result<void> measure_queries(const Parts& parts, Console& console, BenchTable& table, Chart& chart) {
  for (const LawKind law : kLaws) chart.series.push_back({name_of(law), {}, {}});
  chart.series.push_back({"no delay", {}, {}});
  for (const ContactCase& what : pressed_contacts()) {
    console.step("closing the loop over " + what.name);
    auto prepared = PreparedCase::make(what, Profile::kRefined, parts.make_cpu);
    if (!prepared) return prepared.error();
    const auto none = highest_stable_query(what, **prepared, LawKind::kHold, 0);
    if (!none) return none.error();
    chart.labels.push_back(what.name);
    const std::uint32_t areas = what.name == "four" ? 4 : 1;
    add_cell(table, "query: " + what.name, {.law = LawKind::kHold, .delay = 0, .areas = areas}, *none, *none);
    for (std::size_t i = 0; i < 3; ++i) {
      const auto k = highest_stable_query(what, **prepared, kLaws[i], 10);
      if (!k) return k.error();
      add_cell(table, "query: " + what.name, {.law = kLaws[i], .delay = 10, .n = 10, .areas = areas}, *k, *none);
      chart.series[i].y.push_back(*k);
    }
    chart.series[3].y.push_back(*none);
  }
  return {};
}

/// Largest step of force and torque, the chapter's method beside the default.
Result<void> measure_jumps(const Parts& parts, Console& console, BenchFacts& facts, Chart& force, Chart& torque) {
  force.series = {{"chapter", {}, {}}, {"default", {}, {}}};
  torque.series = force.series;
  constexpr int kDelay = 5;
  for (const ContactCase& what : jumping_motions()) {
    console.step("jumps: " + what.name);
    JumpStatistics found[2];
    for (const bool refined : {false, true}) {
      auto prepared = PreparedCase::make(what, refined ? Profile::kRefined : Profile::kPaper, parts.make_cpu);
      if (!prepared) return prepared.error();
      const ForceLawSettings law{.kind = refined ? LawKind::kCorrected : LawKind::kPrinted, .stiffness_n_per_m = 2000, .transitions = kDelay,
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
        fmt::format("largest step a tick {:.2f} N and {:.3f} N·m (chapter {:.2f} and {:.3f}), rms jerk {:.3f} N and {:.4f} N·m a tick² ({:.3f} and {:.4f}), "
                    "least push {:.2f} N ({:.2f}), results step by up to {:.1f} N ({:.1f})",
                    found[1].force_step_n, found[1].torque_step_nm, found[0].force_step_n, found[0].torque_step_nm, found[1].force_jerk,
                    found[1].torque_jerk, found[0].force_jerk, found[0].torque_jerk, found[1].least_push_n, found[0].least_push_n,
                    found[1].response_step_n, found[0].response_step_n));
  }
  return {};
}

/// What a wall gives to a hand that bounces on it.
void measure_energy(BenchTable&, BenchFacts& facts) {
  for (const int delay : {1, 5, 10, 20})
    for (const LawKind law : kLaws) {
      const Cell cell{.law = law, .delay = delay, .n = delay, .pushes_only = true};
      const AxisLoop::Outcome outcome = loop_of(cell, 500).run(kTicks);
      facts.more.emplace_back(fmt::format("energy, {} {} ms", name_of(law), delay),
                              fmt::format("{:.2f} mJ given out, least force {:.2f} N, largest step {:.2f} N (500 N/m, 0.5 kg, 1 N·s/m, dropped from 1 mm by 1 N)",
                                          outcome.energy_out_j * 1e3, outcome.least_force_n, outcome.largest_step_n));
    }
}

}  // namespace

Result<void> bench_stability(const BenchOptions& options, const Parts& parts) {
  Console console;
  BenchFacts facts{.command = "stability", .device = "the CPU reference, in virtual time", .more = {}};
  BenchTable table{{"law", "stiffness_model", "delay_ticks", "n", "mass_kg", "damping", "hand_damping", "areas", "critical_k", "theory_k"}, {}};
  std::vector<Chart> charts;
  measure_formulas(console, table, charts);
  Chart queries = lines("Highest stable K over the real collision query, results 10 ms old", "", "N/m", false, true);
  if (auto done = measure_queries(parts, console, table, queries); !done) return done;
  Chart force = lines("Largest step of the force between two ticks", "", "N", false, true), torque = lines("Largest step of the torque between two ticks", "", "N·m", false, true);
  if (auto done = measure_jumps(parts, console, facts, force, torque); !done) return done;
  measure_energy(table, facts);
  charts.insert(charts.end(), {queries, force, torque});
  for (const auto& [what, text] : facts.more) console.note(what + ": " + text);
  console.finish();
  return write_bench(options.out, facts, table, charts);
}

}  // namespace palpate

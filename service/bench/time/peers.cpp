#include <fmt/format.h>

#include <algorithm>
#include <cstring>
#include <iterator>

#include "service/bench/bench.h"
#include "service/bench/output.h"
#include "service/bench/poses.h"
#include "service/bench/ready_scene.h"
#include "service/bench/time/times.h"
#include "service/cli/answer.h"
#include "service/cli/numbers.h"
#include "service/report/run_summary.h"

namespace palpate {
namespace {

/// Coal is not packaged, so it is not run: on one machine its medians and 99th percentiles were these parts
/// of FCL OBB's, on scenes of these sizes (contacts 25,000 × 1,500; disassembly 100,000 × 2,000, 1,000,000 ×
/// 2,000, 1,000,000 × 100,000).
struct CoalFactor {
  double p50, p99;
};
CoalFactor coal_factor(const SceneGeometry& geometry) {
  constexpr CoalFactor kFactors[] = {{0.82, 0.87}, {0.74, 1.15}, {0.78, 0.98}, {0.87, 0.93}};
  const std::size_t mockup = geometry.mockup.triangles.size(), tool = geometry.tool.triangles.size();
  return kFactors[mockup < 50'000    ? 0
                  : mockup < 300'000 ? 1
                  : tool < 15'000    ? 2
                                     : 3];  // borders: chosen between the sizes
}

/// Where a library's pairs differ from the exact ones, over all poses.
struct Difference {
  std::uint64_t pairs = 0, missing = 0, extra = 0, poses = 0;
};

struct Competitor {
  std::unique_ptr<Peer> peer;
  double build_s = 0;
  Difference difference;
  TimeTable times;
};

/// An engine of palpate's.
struct Engine {
  std::unique_ptr<HostedScene> scene;
  Difference difference;  ///< pairs counted; missing and extra: of the static and mobile triangles in them
  TimeTable times;
};

struct Race {
  std::vector<Engine> engines;
  std::vector<Competitor> peers;
  std::uint64_t exact_pairs = 0;
  std::vector<Pose> poses;

  const SceneGeometry& geometry() const { return engines.front().scene->loaded.geometry; }
  std::vector<FrameKind> kinds;
};

bool wanted(const BenchOptions& options, const std::string& name) {
  if (options.peers.empty()) return true;
  return std::any_of(options.peers.begin(), options.peers.end(), [&](const std::string& word) {
    return name.size() >= word.size() && strncasecmp(name.c_str(), word.c_str(), word.size()) == 0;
  });
}

Result<void> build(const BenchOptions& options, const Parts& parts, Race& race, Console& console) {
  for (auto& peer : parts.make_peers()) {
    if (!wanted(options, peer->name())) continue;
    if (!console.progress(peer->name().c_str(), 0)) return Error{ErrorCode::kInternal, "interrupted"};
    const Stopwatch watch(options.cpu_clock);
    peer->build(race.geometry());
    race.peers.push_back({std::move(peer), watch.us() * 1e-6, {}, {}});
  }
  if (race.peers.empty())
    return Error{ErrorCode::kUsage,
                 "--peers: no library's name begins like that; there are fcl, embree, bullet, cgal"};
  return {};
}

/// Elements of sorted `a` that sorted `b` lacks.
template <class T>
std::uint64_t lacking(const std::vector<T>& a, const std::vector<T>& b) {
  std::vector<T> out;
  std::set_difference(a.begin(), a.end(), b.begin(), b.end(), std::back_inserter(out));
  return out.size();
}

/// Before anything is timed: everybody's pairs against the exact ones.
Result<void> check(const Parts& parts, Race& race, Console& console) {
  const std::unique_ptr<Peer> judge = parts.make_judge();
  judge->build(race.geometry());
  std::vector<TrianglePair> exact, found;
  Answer answer;
  for (std::size_t i = 0; i < race.poses.size(); ++i) {
    const Result<LatticePose> pose = to_lattice(race.poses[i], race.geometry());
    if (!pose) return pose.error();
    judge->find(*pose, exact);
    std::sort(exact.begin(), exact.end());
    race.exact_pairs += exact.size();
    std::vector<std::uint32_t> statics, mobiles;
    for (const auto& [s, m] : exact) statics.push_back(s), mobiles.push_back(m);
    for (auto* ids : {&statics, &mobiles}) {
      std::sort(ids->begin(), ids->end());
      ids->erase(std::unique(ids->begin(), ids->end()), ids->end());
    }
    const auto add = [](Difference& difference, std::uint64_t pairs, std::uint64_t missing,
                        std::uint64_t extra, bool differs) {
      difference.pairs += pairs;
      difference.missing += missing;
      difference.extra += extra;
      difference.poses += differs ? 1 : 0;
    };
    for (Engine& engine : race.engines) {
      if (auto done = answer_frame(*engine.scene, race.poses[i], answer); !done) return done;
      const Contacts& ours = answer.contacts;
      if (&engine == &race.engines.front()) race.kinds.push_back(frame_kind(ours));
      add(engine.difference, ours.pairs, lacking(statics, ours.cst) + lacking(mobiles, ours.cmt),
          lacking(ours.cst, statics) + lacking(ours.cmt, mobiles),
          ours.pairs != exact.size() || statics != ours.cst || mobiles != ours.cmt);
    }
    for (Competitor& competitor : race.peers) {
      competitor.peer->find(*pose, found);
      std::sort(found.begin(), found.end());
      add(competitor.difference, found.size(), lacking(exact, found), lacking(found, exact), found != exact);
    }
    if (!console.progress("checking", 0.3 * static_cast<double>(i) / static_cast<double>(race.poses.size())))
      return Error{ErrorCode::kInternal, "interrupted"};
  }
  return {};
}

/// In turns, pose by pose, nobody always the first. The check was the warm-up.
Result<void> time_all(const BenchOptions& options, Race& race, Console& console) {
  std::vector<TrianglePair> found;
  Answer answer;
  const std::size_t runners = race.peers.size() + race.engines.size();
  for (std::uint64_t round = 0; round < options.rounds; ++round)
    for (std::size_t i = 0; i < race.poses.size(); ++i) {
      for (std::size_t k = 0; k < runners; ++k) {
        const std::size_t runner = (i + k) % runners;
        if (runner >= race.peers.size()) {
          Engine& engine = race.engines[runner - race.peers.size()];
          const DeviceWork before = engine.scene->backend->device_work();
          const Stopwatch watch(options.cpu_clock);
          if (auto done = answer_frame(*engine.scene, race.poses[i], answer); !done) return done;
          const double us = watch.us();
          engine.times.add(race.kinds[i], us, since(before, engine.scene->backend->device_work()));
          continue;
        }
        const Stopwatch watch(options.cpu_clock);
        const Result<LatticePose> pose = to_lattice(race.poses[i], race.geometry());
        if (!pose) return pose.error();
        race.peers[runner].peer->find(*pose, found);
        race.peers[runner].times.add(race.kinds[i], watch.us());
      }
      const double done = static_cast<double>(round * race.poses.size() + i) /
                          static_cast<double>(options.rounds * race.poses.size());
      if (i % 16 == 0 && !console.progress("timing", 0.3 + 0.7 * done))
        return Error{ErrorCode::kInternal, "interrupted"};
    }
  return {};
}

Result<Race> run_race(const BenchOptions& options, const std::string& file, const Parts& parts,
                      Console& console) {
  Race race;
  for (const std::string& backend : asked_backends(options)) {
    auto prepared = ready_scene(options, file, backend, Purpose::kQuery, parts, console);
    if (!prepared) return prepared.error();
    race.engines.push_back({std::move(*prepared), {}, {}});
  }
  auto poses = bench_poses(options, *race.engines.front().scene, parts, console);
  if (!poses) return poses.error();
  race.poses = std::move(*poses);
  console.step("peers");
  if (auto done = build(options, parts, race, console); !done) return done.error();
  if (auto done = check(parts, race, console); !done) return done.error();
  if (auto done = time_all(options, race, console); !done) return done.error();
  console.finish();
  return race;
}

void add_rows(const std::string& scene, const Race& race, BenchTable& table) {
  for (std::size_t kind = 0; kind < 4; ++kind) {
    const TimePercentiles ours = percentiles(race.engines.front().times.times(kind, "total"));
    if (ours.count == 0) continue;
    const auto row = [&](const std::string& name, const TimePercentiles& p, const Difference& d,
                         const DeviceWork& work) {
      table.rows.push_back({scene, name, kFrameKindNames[kind], std::uint64_t{p.count}, p.p50, p.p95, p.p99,
                            cell_of(p.p999), p.max, ours.p50 / p.p50, ours.p99 / p.p99, d.pairs, d.missing,
                            d.extra, d.poses});
      for (BenchCell& cell : work_cells(work)) table.rows.back().push_back(std::move(cell));
    };
    for (const Engine& engine : race.engines)
      row("palpate " + engine.scene->backend->name(), percentiles(engine.times.times(kind, "total")),
          engine.difference, engine.times.work(kind));
    for (const Competitor& competitor : race.peers) {
      const TimePercentiles p = percentiles(competitor.times.times(kind, "total"));
      row(competitor.peer->name(), p, competitor.difference, {});
      if (competitor.peer->name() != "FCL OBB") continue;
      // Coal's share is known for the median in contact and for the 99th percentile of all.
      const CoalFactor factor = coal_factor(race.geometry());
      const double p50 = factor.p50 * p.p50, p99 = factor.p99 * p.p99;
      std::vector<BenchCell> estimated(table.columns.size(), std::string());
      estimated[0] = scene;
      estimated[1] = "Coal OBB (estimated from FCL)";
      estimated[2] = kFrameKindNames[kind];
      estimated[3] = std::uint64_t{0};
      const auto put = [&](const char* column, double value) {
        estimated[static_cast<std::size_t>(std::find(table.columns.begin(), table.columns.end(), column) -
                                           table.columns.begin())] = value;
      };
      if (kind == 0) put("p50_us", p50), put("palpate_p50_ratio", ours.p50 / p50);
      if (kind == 3) put("p99_us", p99), put("palpate_p99_ratio", ours.p99 / p99);
      if (kind == 0 || kind == 3) table.rows.push_back(std::move(estimated));
    }
  }
}

void add_chart(const std::string& scene, const Race& race, std::vector<Chart>& charts) {
  Chart chart{.title = scene,
              .unit = "µs, logarithmic",
              .labels = {"contact, p50", "all, p99", "free, p50"},
              .series = {},
              .log_y = true,
              .x_title = {}};
  const auto series = [&](const std::string& name, const TimeTable& times) {
    chart.series.push_back(
        {name,
         {},
         {percentiles(times.times(0, "total")).p50, percentiles(times.times(3, "total")).p99,
          percentiles(times.times(1, "total")).p50}});
  };
  for (const Engine& engine : race.engines)
    series("palpate " + engine.scene->backend->name() + ", whole frame", engine.times);
  for (const Competitor& competitor : race.peers) series(competitor.peer->name(), competitor.times);
  charts.push_back(std::move(chart));
}

}  // namespace

Result<void> bench_peers(const BenchOptions& options, const Parts& parts) {
  if (!parts.make_peers)
    return Error{ErrorCode::kUsage,
                 "bench peers: this build has no other libraries in it; scripts/bench makes one that has "
                 "(PALPATE_BENCH_PEERS=ON)"};
  catch_interrupts();
  Console console;
  BenchFacts facts{.command = "peers", .device = {}, .more = {}};
  BenchTable table{{"scene", "library", "frames", "count", "p50_us", "p95_us", "p99_us", "p999_us", "max_us",
                    "palpate_p50_ratio", "palpate_p99_ratio", "pairs", "missing", "extra", "poses_different"},
                   {}};
  table.columns.insert(table.columns.end(), kWorkColumns.begin(), kWorkColumns.end());
  std::vector<Chart> charts;
  const double load = load_average();
  for (const std::string& file : options.scenes) {
    const Result<Race> race = run_race(options, file, parts, console);
    if (!race) return race.error();
    const std::string name = scene_name(file);
    const SceneGeometry& geometry = race->geometry();
    add_rows(name, *race, table);
    add_chart(name, *race, charts);
    for (const Engine& engine : race->engines) facts.add_device(device_text(*engine.scene->backend, parts));
    facts.more.emplace_back(name, fmt::format("mock-up {} triangles, tool {}, {} poses, {} exact pairs",
                                              count_text(geometry.mockup.triangles.size()),
                                              count_text(geometry.tool.triangles.size()), race->poses.size(),
                                              count_text(race->exact_pairs)));
    for (const Competitor& competitor : race->peers)
      facts.more.emplace_back(
          fmt::format("{}, {}", name, competitor.peer->name()),
          fmt::format("version {}, trees built in {:.2f} s", competitor.peer->version(), competitor.build_s));
  }
  facts.more.emplace_back("clock", options.cpu_clock ? "CPU time of this process" : "wall");
  facts.more.emplace_back("load average",
                          fmt::format("{:.1f} at the start, {:.1f} at the end", load, load_average()));
  return write_bench(options.out, facts, table, charts);
}

}  // namespace palpate

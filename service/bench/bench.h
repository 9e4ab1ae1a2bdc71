#pragma once
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "model/result.h"
#include "service/cli/cli.h"

namespace CLI {
class App;
}

namespace palpate {

/// What the benches share; each leaves results.csv, results.json and report.html in `out`.
struct BenchOptions {
  std::vector<std::string> scenes;    ///< scene files
  std::vector<std::string> backends;  ///< latency: measured in turns; empty: gpu, else cpu
  std::optional<Profile> profile;     ///< in place of the scenes'
  std::string poses;               ///< CSV of poses; "run": those of a run in virtual time; empty: the path's
  std::uint64_t frames = 400;      ///< poses taken from it, evenly
  std::uint64_t rounds = 3;        ///< how often all poses are gone through
  bool cpu_clock = false;          ///< time the process's own CPU time instead of the wall's
  bool scenes_only = false;        ///< error: without the closed forms
  bool quick = false;              ///< error: two closed forms, few poses, few settings
  std::vector<std::string> peers;  ///< names to measure; empty: all
  double reach = 0.5;              ///< questions: poses are moved by up to so many radii of the tool
  std::uint64_t most_triangles = 1'000'000;  ///< scale: of the largest mock-up
  std::uint64_t largest_batch = 1024;        ///< throughput: poses
  double seconds = 60;                       ///< jitter: how long
  std::string out;
  bool overwrite = false;  ///< results of a bench that `out` has already
};

Result<void> bench_latency(const BenchOptions& options, const Parts& parts);
Result<void> bench_throughput(const BenchOptions& options, const Parts& parts);
Result<void> bench_scale(const BenchOptions& options, const Parts& parts);
Result<void> bench_prepare(const BenchOptions& options, const Parts& parts);
Result<void> bench_error(const BenchOptions& options, const Parts& parts);
Result<void> bench_peers(const BenchOptions& options, const Parts& parts);
Result<void> bench_questions(const BenchOptions& options, const Parts& parts);
Result<void> bench_stability(const BenchOptions& options, const Parts& parts);
Result<void> bench_plan(const BenchOptions& options, const Parts& parts);
Result<void> bench_numerics(const BenchOptions& options, const Parts& parts);
Result<void> bench_force(const BenchOptions& options, const Parts& parts);
Result<void> bench_jitter(const BenchOptions& options, const Parts& parts);

/// Adds `bench` with its subcommands; `options`, `parts` and `outcome` outlive the parsing.
void add_bench_command(CLI::App& app, BenchOptions& options, const Parts& parts, Result<void>& outcome);

}  // namespace palpate

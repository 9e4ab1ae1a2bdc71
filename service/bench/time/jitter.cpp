// `bench jitter`: how late the 1 kHz loop's ticks come while lavapipe, or any back end, works as hard as it
// can; cyclictest beside it.
#include <fcntl.h>
#include <fmt/format.h>
#include <spawn.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <cmath>
#include <csignal>
#include <cstdint>
#include <filesystem>
#include <fstream>
#include <string>
#include <utility>
#include <vector>

#include "service/bench/bench.h"
#include "service/bench/output.h"
#include "service/cli/console.h"
#include "service/cli/scene_host.h"
#include "service/loop/control_loop.h"
#include "service/loop/session.h"
#include "service/loop/thread_share.h"

extern char** environ;  // NOLINT: POSIX names it so

namespace palpate {
namespace {

constexpr int kHistogramUs = 100'000;  // cyclictest counts latenesses up to this, and how many were beyond

/// What is compared. Microseconds after the scheduled time.
struct Lateness {
  std::uint64_t ticks = 0, missed = 0;
  double p50 = 0, p99 = 0, p999 = 0, max = 0;
  std::vector<HistogramBin> bins{};  ///< µs
};

/// cyclictest, begun with the same priority and period; its histogram goes to a file. Ended when this goes.
class Cyclictest {
 public:
  Cyclictest() = default;
  Cyclictest(const Cyclictest&) = delete;
  Cyclictest& operator=(const Cyclictest&) = delete;
  ~Cyclictest() {
    if (child_ <= 0) return;
    kill(child_, SIGTERM);
    waitpid(child_, nullptr, 0);
  }

  /// False: there is none.
  bool begin(const std::string& file, double seconds, bool realtime) {
    const std::string histogram = std::to_string(kHistogramUs),
                      loops = std::to_string(std::llround(seconds * 1000));
    std::vector<std::string> words{"cyclictest",      "--quiet",          "--threads=1",
                                   "--interval=1000", "--loops=" + loops, "--histogram=" + histogram};
    if (realtime && loop_processor() >= 0) words.push_back("--affinity=" + std::to_string(loop_processor()));
    if (realtime)
      words.insert(words.end(),
                   {"--mlockall", "--policy=fifo", "--priority=" + std::to_string(kLoopPriority)});
    else
      words.push_back("--policy=other");
    std::vector<char*> arguments;
    arguments.reserve(words.size() + 1);
    for (std::string& word : words) arguments.push_back(word.data());
    arguments.push_back(nullptr);
    posix_spawn_file_actions_t actions;
    posix_spawn_file_actions_init(&actions);
    posix_spawn_file_actions_addopen(&actions, STDOUT_FILENO, file.c_str(), O_WRONLY | O_CREAT | O_TRUNC,
                                     0644);
    posix_spawn_file_actions_addopen(&actions, STDERR_FILENO, "/dev/null", O_WRONLY, 0);
    const int error = posix_spawnp(&child_, "cyclictest", &actions, nullptr, arguments.data(), environ);
    posix_spawn_file_actions_destroy(&actions);
    if (error != 0) child_ = -1;
    return error == 0;
  }
  bool end() {
    int status = 0;
    const bool ended = waitpid(child_, &status, 0) == child_ && WIFEXITED(status) && WEXITSTATUS(status) == 0;
    child_ = -1;
    return ended;
  }

 private:
  pid_t child_ = -1;
};

/// Lines "000123 000045": microseconds and how often; "# Max Latencies: 00456" and "# Histogram Overflows:
/// 00001".
Result<Lateness> read_histogram(const std::string& file) {
  std::ifstream in(file);
  std::vector<std::uint64_t> counts(kHistogramUs, 0);
  Lateness out;
  std::uint64_t beyond = 0;
  for (std::string line; std::getline(in, line);) {
    if (line.starts_with("# Max Latencies:")) out.max = std::strtod(line.c_str() + 16, nullptr);
    if (line.starts_with("# Histogram Overflows:")) beyond = std::strtoull(line.c_str() + 22, nullptr, 10);
    char* rest = nullptr;
    const std::uint64_t us = std::strtoull(line.c_str(), &rest, 10);
    if (line.empty() || line[0] == '#' || rest == line.c_str() || us >= counts.size()) continue;
    counts[us] = std::strtoull(rest, nullptr, 10);
  }
  for (std::uint64_t us = 0; us < counts.size(); ++us) {
    out.ticks += counts[us];
    out.missed += counts[us] * (us / 1000);
  }
  out.ticks += beyond;
  out.missed += beyond * (kHistogramUs / 1000);
  if (out.ticks == 0) return bad_value(file + ": cyclictest has left no histogram there");
  const auto percentile = [&](double share) {
    const auto rank = static_cast<std::uint64_t>(std::ceil(share * static_cast<double>(out.ticks)));
    std::uint64_t seen = 0;
    for (std::uint64_t us = 0; us < counts.size(); ++us)
      if ((seen += counts[us]) >= rank) return static_cast<double>(us);
    return out.max;
  };
  // In bins of a quarter of an octave, as the loop's own.
  for (double low = 1; low < kHistogramUs; low *= std::sqrt(std::sqrt(2.0))) {
    const double high = low * std::sqrt(std::sqrt(2.0));
    HistogramBin bin{low, high, 0};
    for (auto us = static_cast<std::uint64_t>(std::ceil(low));
         static_cast<double>(us) < high && us < counts.size(); ++us)
      bin.count += counts[us];
    if (bin.count > 0) out.bins.push_back(bin);
  }
  out.p50 = percentile(0.5), out.p99 = percentile(0.99), out.p999 = percentile(0.999);
  return out;
}

/// Goes the path to and fro, so that it lasts for `seconds`.
void repeat(std::vector<PathPoint>& path, double seconds) {
  if (path.size() < 2 || !(path.back().time_s > path.front().time_s)) return;
  const std::vector<PathPoint> once = path;
  for (bool back = true; path.back().time_s < seconds; back = !back) {
    const double begin = path.back().time_s;
    for (std::size_t i = 1; i < once.size(); ++i) {
      PathPoint point = back ? once[once.size() - 1 - i] : once[i];
      point.time_s = begin + (back ? once.back().time_s - point.time_s : point.time_s - once.front().time_s);
      path.push_back(point);
    }
  }
}

void add(BenchTable& table, Chart& chart, Chart& histogram, const std::string& who, const Lateness& late) {
  table.rows.push_back({who, late.ticks, late.missed, late.p50, late.p99, late.p999, late.max});
  chart.series.push_back({who, {}, {late.p50, late.p99, late.p999, late.max}});
  Chart::Series counts{who, {}, {}};
  for (const HistogramBin& bin : late.bins)
    counts.x.push_back(std::sqrt(std::max(bin.low, 0.5) * bin.high)),
        counts.y.push_back(static_cast<double>(bin.count));
  histogram.series.push_back(std::move(counts));
}

}  // namespace

Result<void> bench_jitter(const BenchOptions& options, const Parts& parts) {
  Console console;
  SceneOptions common;
  common.scene = options.scenes.front();
  common.profile = options.profile;
  if (!options.backends.empty()) common.backend = options.backends.front();
  Result<std::unique_ptr<HostedScene>> prepared = prepare_scene(common, Purpose::kSession, parts, console);
  if (!prepared) return prepared.error();
  HostedScene& scene = **prepared;
  repeat(scene.loaded.scene.device.path, options.seconds);
  auto device = parts.make_device("simulated", scene.loaded.scene, scene.loaded.geometry.tool_gc_m, {});
  if (!device) return device.error();
  catch_interrupts();
  std::error_code error;
  std::filesystem::create_directories(options.out, error);
  if (error)
    return bad_value(fmt::format("{}: the directory can't be made ({})", options.out, error.message()));

  BenchFacts facts{.command = "jitter", .device = device_text(*scene.backend, parts), .more = {}};
  const std::string file = (std::filesystem::path(options.out) / "cyclictest.txt").string();
  Cyclictest beside;
  const bool realtime = may_be_realtime();
  const bool compared = beside.begin(file, options.seconds, realtime);
  console.step(fmt::format("{:.0f} s at 1 kHz", options.seconds));
  SessionOptions session;
  session.duration_s = options.seconds;
  session.room = true;
  session.stop = &interrupt_flag();
  const Result<SessionSummary> summary =
      run_session(scene.loaded, *scene.backend, **device, session, nullptr);
  if (!summary) return summary.error();
  if (summary->failure) return *summary->failure;
  if (summary->stopped) return Error{ErrorCode::kInternal, "interrupted"};

  BenchTable table{{"loop", "ticks", "missed", "late_p50_us", "late_p99_us", "late_p999_us", "late_max_us"},
                   {}};
  Chart chart;
  chart.title = "How late a tick comes";
  chart.unit = "µs";
  chart.log_y = true;
  chart.labels = {"p50", "p99", "p99.9", "largest"};
  Chart histogram;
  histogram.title = "Ticks by their lateness, a point a quarter of an octave";
  histogram.unit = "ticks";
  histogram.x_title = "µs after the scheduled time";
  histogram.log_x = histogram.log_y = true;
  const Percentiles& late = summary->lateness_us;
  const Lateness own{summary->ticks, summary->missed_ticks,    late.p50, late.p99, late.p999,
                     late.max,       summary->lateness_bins_us};
  add(table, chart, histogram, "palpate", own);
  if (!compared) {
    facts.more.emplace_back("cyclictest", "not found (Debian: rt-tests); palpate's loop was measured alone");
  } else if (!beside.end()) {
    facts.more.emplace_back("cyclictest", "ended with an error; palpate's loop was measured alone");
  } else {
    const Result<Lateness> other = read_histogram(file);
    if (!other) return other.error();
    add(table, chart, histogram, "cyclictest", *other);
    facts.more.emplace_back("beside cyclictest",
                            fmt::format("p99.9 {:.2f} times as late, {} missed against {}",
                                        late.p999 / std::max(other->p999, 1.0), own.missed, other->missed));
  }
  facts.more.emplace_back("scheduling", realtime ? "SCHED_FIFO for both"
                                                 : "no real-time priority: the ordinary scheduler for both");
  facts.more.emplace_back(
      "load", fmt::format("{} frames answered meanwhile, {:.2f} ms each (median); load average {:.1f}",
                          summary->frames, summary->frame_us.p50 / 1000, load_average()));
  facts.more.emplace_back(
      "age of results",
      fmt::format("{:.0f} ticks median, {:.0f} p99, {:.0f} at most", summary->result_age_ticks.p50,
                  summary->result_age_ticks.p99, summary->result_age_ticks.max));
  for (const std::string& note : summary->notes) facts.more.emplace_back("note", note);
  for (const auto& [what, text] : facts.more) console.note(what + ": " + text);
  console.finish();
  return write_bench(options.out, facts, table, {chart, histogram});
}

}  // namespace palpate

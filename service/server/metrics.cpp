#include "service/server/metrics.h"

#include <fmt/format.h>
#include <unistd.h>

#include <algorithm>
#include <cmath>
#include <fstream>
#include <iterator>

namespace palpate {

namespace {

double resident_bytes() {
  std::ifstream in("/proc/self/statm");
  double total = 0, resident = 0;
  in >> total >> resident;
  return resident * static_cast<double>(::sysconf(_SC_PAGESIZE));
}

}  // namespace

void Distribution::add(double seconds) noexcept {
  const auto bucket =
      static_cast<std::size_t>(std::lower_bound(kBounds.begin(), kBounds.end(), seconds) - kBounds.begin());
  counts_[bucket].fetch_add(1, std::memory_order_relaxed);
  if (seconds > 0) sum_ns_.fetch_add(static_cast<std::uint64_t>(seconds * 1e9), std::memory_order_relaxed);
}

void Distribution::write(std::string& out, std::string_view name, std::string_view labels) const {
  std::uint64_t below = 0;
  const std::string comma = labels.empty() ? "" : ",";
  for (std::size_t i = 0; i <= kBounds.size(); ++i) {
    below += counts_[i].load(std::memory_order_relaxed);
    const std::string bound = i < kBounds.size() ? fmt::format("{}", kBounds[i]) : "+Inf";
    fmt::format_to(std::back_inserter(out), "{}_bucket{{{}{}le=\"{}\"}} {}\n", name, labels, comma, bound,
                   below);
  }
  const std::string braces = labels.empty() ? "" : fmt::format("{{{}}}", labels);
  fmt::format_to(std::back_inserter(out), "{}_sum{} {}\n{}_count{} {}\n", name, braces,
                 static_cast<double>(sum_ns_.load()) / 1e9, name, braces, below);
}

void Metrics::count_request(const std::string& route, unsigned status) {
  const std::lock_guard lock(mutex_);
  ++requests_[{route, status}];
}

void Metrics::add_stage(const char* engine, const char* stage, double us) {
  const std::lock_guard lock(mutex_);
  auto& [sum, frames] = stages_[{engine, stage}];
  sum += us;
  ++frames;
}

std::string Metrics::text(const std::vector<Gauge>& gauges) {
  std::string out;
  const auto put = [&](std::string_view type, std::string_view name, std::string_view help, double value) {
    fmt::format_to(std::back_inserter(out), "# HELP {0} {1}\n# TYPE {0} {2}\n{0} {3}\n", name, help, type,
                   value);
  };
  const auto number = [](const std::atomic<std::uint64_t>& value) {
    return static_cast<double>(value.load(std::memory_order_relaxed));
  };
  put("gauge", "palpate_connections", "Open connections.", number(connections_now));
  put("counter", "palpate_connections_total", "Connections taken.", number(connections));
  put("counter", "palpate_connections_refused_total", "Connections beyond the limit, answered with 503.",
      number(connections_refused));
  put("counter", "palpate_poses_total", "Poses answered for queries.", number(poses));
  put("counter", "palpate_poses_truncated_total",
      "Poses of queries that gave no force because a capacity was too small.", number(truncated));
  put("gauge", "palpate_batches", "Queries under way or waiting for their turn.", number(batches_now));
  put("counter", "palpate_scenes_prepared_total", "Scenes prepared.", number(scenes_prepared));
  put("counter", "palpate_scenes_evicted_total", "Scenes evicted for the memory budget.",
      number(scenes_evicted));
  put("counter", "palpate_upload_bytes_total", "Bytes of uploads written.", number(upload_bytes));
  put("gauge", "palpate_viewers", "Telemetry connections.", number(viewers_now));
  put("counter", "palpate_telemetry_sent_total", "Telemetry messages sent.", number(telemetry_sent));
  put("counter", "palpate_telemetry_dropped_total", "Telemetry messages that a slow viewer missed.",
      number(telemetry_dropped));
  put("gauge", "palpate_loops", "Haptic connections.", number(loops_now));
  put("counter", "palpate_loop_poses_total", "Poses answered for haptic connections.", number(loop_poses));
  put("counter", "palpate_loop_poses_skipped_total", "Poses of haptic connections that a newer one overtook.",
      number(loop_skipped));
  put("counter", "palpate_session_ticks_total", "Ticks of sessions.", number(session_ticks));
  put("counter", "palpate_session_missed_ticks_total", "Ticks that sessions missed.",
      number(session_missed_ticks));
  put("gauge", "process_resident_memory_bytes", "Memory of the process that is in RAM.", resident_bytes());
  put("counter", "palpate_backend_errors_total", "Queries that a back end failed.", number(backend_errors));
  for (const Gauge& gauge : gauges) put("gauge", gauge.name, gauge.help, gauge.value);

  const auto distribution = [&](const Distribution& d, std::string_view name, std::string_view help) {
    fmt::format_to(std::back_inserter(out), "# HELP {0} {1}\n# TYPE {0} histogram\n", name, help);
    d.write(out, name, "");
  };
  distribution(query_s, "palpate_query_seconds", "A pose of a query, from pose in to wrench out.");
  distribution(loop_s, "palpate_loop_seconds",
               "A pose of a haptic connection, from its arrival to its answer.");
  distribution(lateness_s, "palpate_tick_lateness_seconds", "Wake-up of a session's tick after its time.");
  distribution(result_age_s, "palpate_result_age_seconds", "Age of the result that a session's tick used.");
  distribution(session_frame_s, "palpate_session_frame_seconds",
               "A frame of a session, waiting for its turn included.");

  const std::lock_guard lock(mutex_);
  out +=
      "# HELP palpate_stage_seconds_total Time in a stage of the frame, by the engine that answered.\n# TYPE "
      "palpate_stage_seconds_total counter\n";
  for (const auto& [stage, sum] : stages_)
    fmt::format_to(std::back_inserter(out), "palpate_stage_seconds_total{{engine=\"{}\",stage=\"{}\"}} {}\n",
                   stage.first, stage.second, sum.first / 1e6);
  out +=
      "# HELP palpate_stage_frames_total Frames that had the stage.\n# TYPE palpate_stage_frames_total "
      "counter\n";
  for (const auto& [stage, sum] : stages_)
    fmt::format_to(std::back_inserter(out), "palpate_stage_frames_total{{engine=\"{}\",stage=\"{}\"}} {}\n",
                   stage.first, stage.second, sum.second);
  out +=
      "# HELP palpate_requests_total Requests by route and status.\n# TYPE palpate_requests_total counter\n";
  for (const auto& [key, count] : requests_)
    fmt::format_to(std::back_inserter(out), "palpate_requests_total{{route=\"{}\",status=\"{}\"}} {}\n",
                   key.first, key.second, count);
  return out;
}

}  // namespace palpate

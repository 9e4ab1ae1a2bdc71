#pragma once
#include <array>
#include <atomic>
#include <cstdint>
#include <map>
#include <mutex>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

namespace palpate {

/// Counts of durations in buckets with fixed bounds. add() is lock-free: any thread may call it.
class Distribution {
 public:
  static constexpr std::array<double, 12> kBounds = {1e-5, 5e-5, 1e-4, 5e-4, 1e-3, 2.5e-3,
                                                     5e-3, 1e-2, 5e-2, 0.25, 1,    10};  ///< s

  void add(double seconds) noexcept;
  void write(std::string& out, std::string_view name, std::string_view labels) const;

 private:
  std::array<std::atomic<std::uint64_t>, kBounds.size() + 1> counts_{};
  std::atomic<std::uint64_t> sum_ns_{0};
};

/// What /metrics tells. Counters are atomics that whoever sees the event raises; gauges are asked for when
/// somebody looks.
struct Metrics {
  std::atomic<std::uint64_t> connections_now{0}, connections{0}, connections_refused{0};
  std::atomic<std::uint64_t> poses{0}, truncated{0}, batches_now{0}, scenes_prepared{0}, scenes_evicted{0},
      upload_bytes{0};
  std::atomic<std::uint64_t> telemetry_sent{0}, telemetry_dropped{0}, viewers_now{0}, loops_now{0},
      loop_poses{0}, loop_skipped{0};
  std::atomic<std::uint64_t> session_ticks{0}, session_missed_ticks{0}, backend_errors{0};
  Distribution query_s, loop_s, lateness_s, result_age_s, session_frame_s;

  void count_request(const std::string& route, unsigned status);
  /// A frame's stages, as Contacts::times has them.
  void add_stage(const char* engine, const char* stage, double us);

  struct Gauge {
    std::string name, help;
    double value = 0;
  };
  /// The exposition format, version 0.0.4.
  std::string text(const std::vector<Gauge>& gauges);

 private:
  std::mutex mutex_;
  std::map<std::pair<std::string, unsigned>, std::uint64_t> requests_;
  std::map<std::pair<std::string, std::string>, std::pair<double, std::uint64_t>>
      stages_;  ///< by engine and stage: sum of µs, frames
};

}  // namespace palpate

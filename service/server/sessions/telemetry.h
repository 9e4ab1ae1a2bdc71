#pragma once
#include <chrono>
#include <cstdint>
#include <functional>
#include <list>
#include <memory>
#include <mutex>
#include <optional>
#include <string>

#include "service/loop/histogram.h"
#include "service/loop/run_record.h"
#include "service/server/http/http_message.h"
#include "service/server/metrics.h"

namespace palpate {

/// A telemetry message, made once for all viewers. What differs from viewer to viewer, the count of messages
/// it missed, is put in by them.
struct TelemetryMessage {
  std::uint64_t seq = 0;
  std::string json;    ///< from `,"tick":` to the closing brace
  std::string binary;  ///< whole; `dropped` is 0
};

/// Makes telemetry of what a session records, about 60 times a second and only while somebody looks on, and
/// gives the newest to everybody. on_tick and on_frame come from the session's recording thread; the rest
/// from any thread.
class Telemetry final : public RunObserver {
 public:
  /// `then` gets every record too; may be null.
  Telemetry(Metrics& metrics, RunObserver* then) : metrics_(metrics), then_(then) {}

  Result<void> on_tick(const TickRecord& tick) override;
  Result<void> on_frame(const FrameRecord& frame) override;

  /// No message will come any more; viewers are told `reason`.
  void finish(const std::string& reason);

  /// `wake` is called whenever there is something new, until the handle is gone.
  std::shared_ptr<void> attach(std::function<void()> wake);
  std::shared_ptr<const TelemetryMessage> newest() const;
  std::optional<std::string> over() const;  ///< the reason, once finished
  std::size_t viewers() const;
  TickRecord last_tick() const;
  /// So far.
  struct Punctuality {
    double age_p50 = 0, age_p99 = 0, age_max = 0;  ///< of results, ticks
    double lateness_us_p50 = 0, lateness_us_p99 = 0, lateness_us_max = 0;
  };
  Punctuality punctuality() const;

 private:
  using Clock = std::chrono::steady_clock;
  void publish();
  void wake_all();

  Metrics& metrics_;
  RunObserver* then_;

  // The recording thread's:
  TickRecord tick_;
  double lateness_max_us_ = 0;
  std::uint64_t missed_counted_ = 0, seq_ = 0;
  Clock::time_point last_{}, last_frame_{};
  std::string frame_json_, frame_binary_;  ///< of the newest frame not told yet; empty: none
  std::uint32_t counts_[7] = {};           ///< lengths of the six lists, areas: of frame_binary_
  bool truncated_ = false;
  double frame_us_ = 0;
  Pose frame_pose_;

  mutable std::mutex mutex_;
  std::list<std::function<void()>> viewers_;
  std::shared_ptr<const TelemetryMessage> newest_;
  std::optional<std::string> over_;
  TickRecord shown_;
  Histogram ages_, lateness_ns_;
};

/// A viewer's end of a session's telemetry. `hello`: its first message.
std::shared_ptr<SocketHandler> make_viewer(std::shared_ptr<Telemetry> telemetry, std::string hello,
                                           bool binary, Metrics& metrics);

}  // namespace palpate

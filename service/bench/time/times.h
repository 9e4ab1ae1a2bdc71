#pragma once
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "model/collision_backend.h"
#include "model/contact/contacts.h"

namespace palpate {

/// Microseconds that have passed, or that this process has run, since the stopwatch was made.
class Stopwatch {
 public:
  explicit Stopwatch(bool cpu_clock);
  double us() const;

 private:
  bool cpu_clock_;
  double start_us_;
};

/// Percentiles of measured times, nearest rank; all 0 without samples.
struct TimePercentiles {
  std::size_t count = 0;
  double p50 = 0, p95 = 0, p99 = 0, max = 0;  ///< µs
  std::optional<double>
      p999;  ///< of at least 1,000 samples: of fewer it would be the largest by another name
};
TimePercentiles percentiles(std::vector<double> times_us);

/// What a frame was like. A frame is `kApart` when the search found nothing that may touch, so that nothing
/// had to be decided.
enum class FrameKind : std::uint8_t { kContact, kFree, kApart };
inline constexpr const char* kFrameKindNames[] = {"contact", "free", "apart",
                                                  "all"};  ///< and all of them together
FrameKind frame_kind(const Contacts& contacts);

/// What was asked of a device between two looks at CollisionBackend::device_work.
DeviceWork since(const DeviceWork& before, const DeviceWork& after);
/// Of each count by itself; nothing of nothing.
DeviceWork median_of(std::vector<DeviceWork> all);

/// Times of one thing under test, by kind of frame and by stage.
class TimeTable {
 public:
  /// Adds a frame's total, its stages, as `host` what is left, and what it asked of a device.
  void add(const Contacts& contacts, double total_us, const DeviceWork& work);
  /// A frame's stages, and as `host` what of `total_us` is left; the total itself is not added.
  void add_stages(const Contacts& contacts, double total_us);
  void add(FrameKind kind, double total_us) { put(kind, "total", total_us); }
  void add(FrameKind kind, double total_us, const DeviceWork& work);  ///< a frame without its stages

  /// Stages in the order of their first appearance; `total` is the first.
  const std::vector<std::string>& stages() const { return order_; }
  /// `kind` 3: frames of all kinds.
  std::vector<double> times(std::size_t kind, const std::string& stage) const;
  /// Its frames' medians, one by one.
  DeviceWork work(std::size_t kind) const;

 private:
  void put(FrameKind kind, const std::string& stage, double us);

  std::vector<std::string> order_;
  std::map<std::string, std::vector<double>> times_[3];
  std::vector<DeviceWork> work_[3];
};

}  // namespace palpate

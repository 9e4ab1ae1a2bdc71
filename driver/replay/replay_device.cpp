#include "driver/replay/replay_device.h"

#include <glm/gtc/quaternion.hpp>
#include <utility>
#include <vector>

#include "driver/replay/trace_file.h"

namespace palpate::replay {
namespace {

// A row stands at a tick when it is less than this from it, s: the recorder prints times to the last bit of
// tick / 1000.
constexpr double kSameTime = 1e-9;

class ReplayDevice final : public HapticDevice {
 public:
  ReplayDevice(std::vector<TraceRow> rows, double max_force_n, double max_torque_nm)
      : rows_(std::move(rows)), max_force_n_(max_force_n), max_torque_nm_(max_torque_nm) {}

  std::string name() const override { return "replay"; }

  DeviceCapabilities capabilities() const override {
    return {.sensed = {true, true, true, true, true, true},
            .actuated = {true, true, true, true, true, true},
            .max_force_n = max_force_n_,
            .max_torque_nm = max_torque_nm_};
  }

  double motion_s() const override { return rows_.back().time_s; }

  Result<void> open() override {
    tick_ = 0;
    at_ = 0;
    open_ = true;
    return {};
  }
  void close() noexcept override { open_ = false; }

  DeviceSample read() noexcept override {
    DeviceSample sample;
    sample.state = open_ ? DeviceState::kReady : DeviceState::kClosed;
    const double now = static_cast<double>(tick_) / 1000;  // as the recorder counts: the same double
    sample.time_ns = tick_ * std::int64_t{1'000'000};
    while (at_ + 1 < rows_.size() && rows_[at_ + 1].time_s <= now + kSameTime) ++at_;
    const TraceRow& row = rows_[at_];
    sample.pose = row.pose;
    sample.stage = row.stage;
    if (at_ + 1 < rows_.size() && now > row.time_s + kSameTime) {
      const TraceRow& next = rows_[at_ + 1];
      const double share = (now - row.time_s) / (next.time_s - row.time_s);
      sample.pose.position += share * (next.pose.position - row.pose.position);
      sample.pose.rotation = glm::normalize(glm::slerp(row.pose.rotation, next.pose.rotation, share));
    }
    if (open_) ++tick_;
    return sample;
  }

  void write(const Wrench& /*wrench*/, const Vec3& /*gc*/) noexcept override {}

 private:
  std::vector<TraceRow> rows_;
  double max_force_n_, max_torque_nm_;
  std::int64_t tick_ = 0;
  std::size_t at_ = 0;  // the last row at or before the present tick
  bool open_ = false;
};

}  // namespace

Result<std::unique_ptr<HapticDevice>> make_replay(const std::string& trace_file, double max_force_n,
                                                  double max_torque_nm) {
  auto rows = read_trace(trace_file);
  if (!rows) return rows.error();
  return std::unique_ptr<HapticDevice>(
      std::make_unique<ReplayDevice>(std::move(*rows), max_force_n, max_torque_nm));
}

}  // namespace palpate::replay

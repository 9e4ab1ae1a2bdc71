#include "driver/falcon/falcon_device.h"

#include <cmath>

#include "driver/device_notes.h"
#include "driver/falcon/falcon_link.h"
#include "driver/limits.h"

namespace palpate::falcon {
namespace {

constexpr const char* kLying =
    "the Falcon's encoders say what its arms can't do; unplug it, plug it in and home it anew";

class FalconDevice final : public HapticDevice, public DeviceNotes {
 public:
  FalconDevice(const FalconSettings& settings, std::vector<std::uint8_t> image, const Pose& start,
               OpenPort open_port)
      : settings_(settings),
        workspace_(settings.workspace, start),
        link_(settings, std::move(image), std::move(open_port)) {
    sample_.pose = start;
  }
  ~FalconDevice() override { close(); }

  std::string name() const override { return "falcon"; }

  DeviceCapabilities capabilities() const override {
    DeviceCapabilities can;
    can.sensed = can.actuated = {true, true, true, false, false, false};
    can.max_force_n = settings_.max_force_n;
    can.max_stiffness_n_per_m = 3000;
    return can;
  }

  Result<void> open() override {
    sample_.state = DeviceState::kOpening;
    workspace_.release();
    auto started = link_.start();
    return started ? started : Error{started.error().code, "falcon: " + started.error().sentence};
  }

  void close() noexcept override {
    link_.publish({});
    link_.stop();
    sample_.state = DeviceState::kClosed;
  }

  DeviceSample read() noexcept override {
    if (const FromDevice* news = link_.take()) device_ = *news;
    if (sample_.state != DeviceState::kClosed) sample_.state = device_.state;
    sample_.time_ns = device_.time_ns;
    sample_.buttons = device_.buttons;
    sample_.clutched = lying_ = false;
    if (sample_.state != DeviceState::kReady) {
      grip_ = kCentre;
      workspace_.release();
      return sample_;
    }
    angles_ = angles_of_encoders(device_.encoders);
    const std::optional<Vec3> grip = possible(angles_) ? position_of_angles(angles_, grip_) : std::nullopt;
    if (!grip) {
      // Angles that no position of the legs has: the encoders lie, so nothing may be felt until they don't.
      sample_.state = DeviceState::kHoming;
      lying_ = true;
      workspace_.release();
      return sample_;
    }
    grip_ = *grip;
    sample_.pose.position = workspace_.position(grip_ - kCentre, device_.buttons);
    sample_.clutched = workspace_.clutched();
    return sample_;
  }

  std::vector<std::string> notes() const override {
    const BusCounts& bus = link_.counts();
    if (bus.late + bus.malformed + bus.jumps + bus.errors == 0) return {};
    return {"falcon: of " + std::to_string(bus.reports) + " reports " + std::to_string(bus.late) +
            " came late, " + std::to_string(bus.malformed) + " more were malformed, " +
            std::to_string(bus.jumps) + " had encoders that jumped; " + std::to_string(bus.errors) +
            " bus errors"};
  }

  const char* guidance() const noexcept override { return lying_ ? kLying : device_.guidance; }

  void write(const Wrench& wrench, const Vec3& /*gc*/) noexcept override {
    FromLoop wanted;
    if (sample_.state == DeviceState::kReady && !sample_.clutched && finite(wrench.force) &&
        wrench.force != Vec3(0)) {
      if (const auto torques = torques_of_force(angles_, grip_, workspace_.device(wrench.force))) {
        std::array<double, 3> counts{};
        for (std::size_t i = 0; i < 3; ++i) counts[i] = settings_.counts_per_newton_metre * (*torques)[i];
        wanted.motors = limited(counts);
      }
    }
    link_.publish(wanted);
  }

 private:
  FalconSettings settings_;
  Workspace workspace_;
  FalconLink link_;
  FromDevice device_;
  DeviceSample sample_;
  Angles angles_{};
  Vec3 grip_ = kCentre;
  bool lying_ = false;
};

}  // namespace

Result<std::unique_ptr<UsbPort>> open_first_falcon() {
  constexpr std::array ids{kUsbId};
  return UsbPort::open(ids, 0);
}

bool runs_firmware(std::unique_ptr<UsbPort> port) {
  SerialLine line(std::move(port));
  return line.begin() && set_running_line(line) && answers(line);
}

Result<std::unique_ptr<HapticDevice>> make_falcon(const FalconSettings& settings, const Pose& start,
                                                  OpenPort open_port) {
  if (!(std::isfinite(settings.counts_per_newton_metre) && settings.max_force_n > 0 &&
        settings.homing_timeout_s > 0 && settings.workspace.scale > 0))
    return bad_value(
        "the Falcon's gain must be finite, its force limit, homing time and workspace scale above 0");
  std::vector<std::uint8_t> image;
  if (!settings.firmware.empty()) {
    auto read = read_firmware(settings.firmware);
    if (!read) return read.error();
    image = std::move(*read);
  }
  return std::unique_ptr<HapticDevice>(
      new FalconDevice(settings, std::move(image), start, std::move(open_port)));
}

}  // namespace palpate::falcon

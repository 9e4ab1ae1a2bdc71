#include "driver/spacemouse/spacemouse_device.h"

#include <array>
#include <atomic>
#include <chrono>
#include <thread>

#include "driver/spacemouse/report.h"
#include "model/latest_value.h"

namespace palpate::spacemouse {
namespace {

using std::chrono::milliseconds;

constexpr std::uint8_t kIn = 0x81;
constexpr std::size_t kReportBytes = 16;  // the longest report has 13
constexpr auto kReopenEvery = milliseconds(250);
constexpr auto kPump = std::chrono::microseconds(20'000);  // only how soon a stop is seen
constexpr const char* kUnplugged = "the SpaceMouse is gone; plug it in again";

struct News {
  Cap cap;
  bool plugged = true;
  std::int64_t time_ns = 0;
};

class SpaceMouseDevice final : public HapticDevice {
 public:
  SpaceMouseDevice(const SpaceMouseSettings& settings, const Pose& start, OpenPort open_port)
      : settings_(settings),
        axes_(settings.workspace, Pose{}),
        rate_(scaled(settings), start),
        open_port_(std::move(open_port)) {
    sample_.pose = start;
  }
  ~SpaceMouseDevice() override { close(); }

  std::string name() const override { return "spacemouse"; }

  DeviceCapabilities capabilities() const override {
    DeviceCapabilities can;
    can.sensed = {true, true, true, true, true, true};
    return can;
  }

  Result<void> open() override {
    close();
    auto port = open_port_();
    if (!port) return Error{port.error().code, "spacemouse: " + port.error().sentence};
    port_ = std::move(*port);
    if (auto begun = begin(); !begun)
      return Error{begun.error().code, "spacemouse: " + begun.error().sentence};
    sample_.state = DeviceState::kReady;
    stop_ = false;
    thread_ = std::thread([this] { run(); });
    return {};
  }

  void close() noexcept override {
    stop_ = true;
    if (thread_.joinable()) thread_.join();
    port_.reset();
    sample_.state = DeviceState::kClosed;
  }

  DeviceSample read() noexcept override {
    if (const News* news = news_.take()) newest_ = *news;
    if (sample_.state == DeviceState::kClosed) return sample_;
    sample_.state = newest_.plugged ? DeviceState::kReady : DeviceState::kOpening;
    sample_.buttons = newest_.cap.buttons;
    sample_.time_ns = newest_.time_ns;
    sample_.clutched = (newest_.cap.buttons & settings_.workspace.clutch_buttons) != 0;
    std::array<double, 6> deflection{};
    if (newest_.plugged && !sample_.clutched) {
      const auto& a = newest_.cap.axes;
      const Vec3 push = axes_.world(Vec3(a[0], a[1], a[2]) / double{kFullDeflection});
      const Vec3 turn = axes_.world(Vec3(a[3], a[4], a[5]) / double{kFullDeflection});
      deflection = {push.x, push.y, push.z, turn.x, turn.y, turn.z};
    }
    sample_.pose = rate_.step(deflection);
    return sample_;
  }

  const char* guidance() const noexcept override { return newest_.plugged ? "" : kUnplugged; }
  void write(const Wrench& /*wrench*/, const Vec3& /*gc*/) noexcept override {}

 private:
  static RateSettings scaled(const SpaceMouseSettings& settings) {
    RateSettings rate = settings.rate;
    rate.speed_m_per_s *= settings.workspace.scale;
    return rate;
  }

  Result<void> begin() {
    now_ = {};
    auto listening = port_->listen(kIn, true, kReportBytes, [this](std::span<const std::uint8_t> bytes) {
      if (!take(bytes, now_.cap)) return;
      now_.time_ns = std::chrono::duration_cast<std::chrono::nanoseconds>(
                         std::chrono::steady_clock::now().time_since_epoch())
                         .count();
      news_.publish(now_);
    });
    // The ring's light: HID's SET_REPORT of output report 4. A model without one refuses it, which is no
    // fault.
    constexpr std::array<std::uint8_t, 2> light{4, 1};
    if (listening) (void)port_->control(0x21, 0x09, 0x0204, 0, milliseconds(100), light);
    return listening;
  }

  void run() {
    while (!stop_) {
      if (port_ && !port_->lost()) {
        port_->pump(kPump);
        continue;
      }
      port_.reset();
      now_ = {};
      now_.plugged = false;
      news_.publish(now_);
      for (int i = 0; i < kReopenEvery / milliseconds(10) && !stop_; ++i)
        std::this_thread::sleep_for(milliseconds(10));
      if (stop_) return;
      if (auto port = open_port_()) {
        port_ = std::move(*port);
        if (begin()) news_.publish(now_);
      }
    }
  }

  SpaceMouseSettings settings_;
  Workspace axes_;
  RateControl rate_;
  OpenPort open_port_;
  std::unique_ptr<UsbPort> port_;  // the thread's, once it runs
  std::thread thread_;
  std::atomic<bool> stop_{false};
  LatestValue<News> news_;
  News now_;     // the thread's
  News newest_;  // the control loop's
  DeviceSample sample_;
};

}  // namespace

Result<std::unique_ptr<UsbPort>> open_first_spacemouse() { return UsbPort::open(kModels, 0); }

std::unique_ptr<HapticDevice> make_spacemouse(const SpaceMouseSettings& settings, const Pose& start,
                                              OpenPort open_port) {
  return std::make_unique<SpaceMouseDevice>(settings, start, std::move(open_port));
}

}  // namespace palpate::spacemouse

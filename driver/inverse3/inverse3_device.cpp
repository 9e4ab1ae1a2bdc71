#include "driver/inverse3/inverse3_device.h"

#include "driver/device_notes.h"
#include "driver/inverse3/inverse3_link.h"
#include "driver/limits.h"

namespace palpate::inverse3 {
namespace {

/// About the middle of the arm's workspace, m, its own frame.
constexpr Vec3 kCentre(0, -0.12, 0.15);

class Inverse3Device final : public HapticDevice, public DeviceNotes {
 public:
  Inverse3Device(const Inverse3Settings& settings, const Pose& start)
      : settings_(settings), workspace_(settings.workspace, start), link_(settings.port) {
    sample_.pose = start;
    tool_anchor_ = start.rotation;
  }
  ~Inverse3Device() override { close(); }

  std::string name() const override { return "inverse3"; }

  DeviceCapabilities capabilities() const override {
    DeviceCapabilities can;
    const bool turns = link_.has_grip();
    can.sensed = {true, true, true, turns, turns, turns};
    can.actuated = {true, true, true, false, false, false};
    can.max_force_n = settings_.max_force_n;
    return can;
  }

  Result<void> open() override {
    sample_.state = DeviceState::kOpening;
    release();
    auto started = link_.start();
    return started ? started : Error{started.error().code, "inverse3: " + started.error().sentence};
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
    sample_.clutched = false;
    if (sample_.state != DeviceState::kReady) {
      release();
      return sample_;
    }
    sample_.pose.position = workspace_.position(device_.cursor - kCentre, device_.buttons);
    sample_.clutched = workspace_.clutched();
    turn();
    return sample_;
  }

  std::vector<std::string> notes() const override {
    const LinkCounts& counts = link_.counts();
    if (counts.broken + counts.lost == 0) return {};
    return {"inverse3: beside " + std::to_string(counts.states) + " states " + std::to_string(counts.broken) +
            " messages had none; service or arm went away " + std::to_string(counts.lost) + " times"};
  }

  const char* guidance() const noexcept override { return device_.guidance; }

  void write(const Wrench& wrench, const Vec3& /*gc*/) noexcept override {
    FromLoop wanted;
    if (sample_.state == DeviceState::kReady && !sample_.clutched && finite(wrench.force))
      wanted.force = shortened(workspace_.device(wrench.force), settings_.max_force_n);
    link_.publish(wanted);
  }

 private:
  void release() noexcept {
    workspace_.release();
    held_ = false;
  }

  /// The tool turns as the grip has turned since it was taken up. A grip that was silent, or turned while
  /// the clutch was held, is taken up anew: the tool doesn't jump after it.
  void turn() noexcept {
    if (!link_.has_grip()) return;
    if (!device_.turned || sample_.clutched || !held_) {
      grip_anchor_ = device_.orientation;
      tool_anchor_ = sample_.pose.rotation;
      held_ = device_.turned;
      return;
    }
    const Quat since = device_.orientation * glm::conjugate(grip_anchor_);
    const Vec3 axis = workspace_.world(Vec3(since.x, since.y, since.z));
    sample_.pose.rotation = glm::normalize(Quat(since.w, axis.x, axis.y, axis.z) * tool_anchor_);
  }

  Inverse3Settings settings_;
  Workspace workspace_;
  Inverse3Link link_;
  FromDevice device_;
  DeviceSample sample_;
  Quat grip_anchor_{1, 0, 0, 0}, tool_anchor_{1, 0, 0, 0};
  bool held_ = false;
};

}  // namespace

std::unique_ptr<HapticDevice> make_inverse3(const Inverse3Settings& settings, const Pose& start) {
  return std::make_unique<Inverse3Device>(settings, start);
}

}  // namespace palpate::inverse3

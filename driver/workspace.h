#pragma once
#include <array>
#include <cstdint>

#include "model/pose.h"

namespace palpate {

/// How a device's workspace lies in the scene.
struct WorkspaceSettings {
  double scale = 1;                                   ///< metres of the tool for a metre of the hand; > 0
  std::array<std::array<double, 3>, 3> axes{{{1, 0, 0}, {0, 1, 0}, {0, 0, 1}}};   ///< row i: world axis i in device axes; a rotation
  std::uint32_t clutch_buttons = 0;                   ///< while any of these is held the hand moves and the tool doesn't
};

/// Maps a device's positions to the tool's and the scene's forces back. The tool starts where the scene puts it, whatever the
/// hand holds then; the clutch lets the hand begin anew elsewhere. Forces are turned and not scaled: a hand that moves the
/// tool by `scale` feels a stiffness of scale × K. Pure, no clock, nothing allocated.
class Workspace {
 public:
  Workspace(const WorkspaceSettings& settings, const Pose& start) noexcept;

  /// The tool's position for a hand at `device` (m, device frame). Call once a tick.
  Vec3 position(const Vec3& device, std::uint32_t buttons) noexcept;
  /// The next position() keeps the tool where it is: the device's zero has moved (homing, plugged in again).
  void release() noexcept { held_ = false; }
  /// A direction of the device in the scene's axes, and back: a force in the scene as the device's axes see it.
  Vec3 world(const Vec3& device) const noexcept;
  Vec3 device(const Vec3& world) const noexcept;

  bool clutched() const noexcept { return clutched_; }

 private:
  WorkspaceSettings settings_;
  Vec3 tool_, tool_anchor_{0}, hand_anchor_{0};
  bool held_ = false, clutched_ = false;
};

}  // namespace palpate

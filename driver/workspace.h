#pragma once
#include <cstdint>

#include "model/lattice/pose.h"
#include "model/scene/workspace_settings.h"

namespace palpate {

/// Maps a device's positions to the tool's and the scene's forces back. The tool starts where the scene puts
/// it, whatever the hand holds then, or where the settings' offset says; the clutch lets the hand begin anew
/// elsewhere. Forces are turned and not scaled: a hand that moves the tool by `scale` feels a stiffness of
/// scale × K. Pure, no clock, nothing allocated.
class Workspace {
 public:
  Workspace(const WorkspaceSettings& settings, const Pose& start) noexcept;

  /// The tool's position for a hand at `device` (m, device's axes, from the middle of its workspace). Call
  /// once a tick.
  Vec3 position(const Vec3& device, std::uint32_t buttons) noexcept;
  /// The next position() takes the hand up anew: the device's zero has moved (homing, plugged in again).
  /// Without an offset the tool stays where it is.
  void release() noexcept { held_ = false; }
  /// A direction of the device in the scene's axes, and back: a force in the scene as the device's axes see
  /// it.
  Vec3 world(const Vec3& device) const noexcept;
  Vec3 device(const Vec3& world) const noexcept;

  bool clutched() const noexcept { return clutched_; }

 private:
  WorkspaceSettings settings_;
  Vec3 tool_, tool_anchor_{0}, hand_anchor_{0};
  bool held_ = false, clutched_ = false;
};

}  // namespace palpate

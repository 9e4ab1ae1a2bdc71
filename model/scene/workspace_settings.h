#pragma once
#include <array>
#include <cstdint>
#include <optional>

#include "model/lattice/vector.h"

namespace palpate {

/// How a device's workspace lies in the scene: scene file, device.workspace.
struct WorkspaceSettings {
  double scale = 1;  ///< metres of the tool for a metre of the hand; > 0
  /// World place of the tool's origin for a hand in the middle of the device's workspace, m. Empty: the tool
  /// begins where the scene puts it, whatever the hand holds then.
  std::optional<Vec3> offset_m{};
  std::array<std::array<double, 3>, 3> axes{
      {{1, 0, 0}, {0, 1, 0}, {0, 0, 1}}};  ///< row i: world axis i in device axes; a rotation
  std::uint32_t clutch_buttons = 0;        ///< while any of these is held the hand moves and the tool doesn't
};

}  // namespace palpate

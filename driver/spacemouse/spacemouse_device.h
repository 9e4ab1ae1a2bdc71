#pragma once
#include <functional>
#include <memory>

#include "driver/haptic_device.h"
#include "driver/rate_control.h"
#include "driver/usb_port.h"
#include "driver/workspace.h"

namespace palpate::spacemouse {

struct SpaceMouseSettings {
  RateSettings rate;
  WorkspaceSettings workspace;  ///< its axes turn the cap's (x right, y towards the user, z down), its scale
                                ///< multiplies the speed, its clutch holds the tool; its offset is not used
};

using OpenPort = std::function<Result<std::unique_ptr<UsbPort>>()>;
Result<std::unique_ptr<UsbPort>> open_first_spacemouse();

/// A cap that is pushed and turned: six axes steer the tool's velocity, no force comes back. open() claims
/// the device, from the kernel's driver too, and lights its ring. A device that is unplugged counts as a cap
/// at rest, and is found again when it comes back.
std::unique_ptr<HapticDevice> make_spacemouse(const SpaceMouseSettings& settings, const Pose& start,
                                              OpenPort open_port = open_first_spacemouse);

}  // namespace palpate::spacemouse

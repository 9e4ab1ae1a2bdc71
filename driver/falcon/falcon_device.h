#pragma once
#include <functional>
#include <memory>
#include <string>

#include "driver/haptic_device.h"
#include "driver/usb_port.h"
#include "driver/workspace.h"
#include "model/result.h"

namespace palpate::falcon {

inline constexpr UsbId kUsbId{0x0403, 0xcb48};

struct FalconSettings {
  std::string firmware;  ///< the user's file; empty: only a device that runs its firmware already can be used
  double counts_per_newton_metre =
      -10000;  ///< motor gain. Not calibrated publicly: forces are about right, no more is claimed
  double max_force_n = 8;  ///< the device's rating
  double homing_timeout_s = 60;
  WorkspaceSettings workspace;
};

/// How a port comes about: by default the first Falcon plugged in.
using OpenPort = std::function<Result<std::unique_ptr<UsbPort>>()>;
Result<std::unique_ptr<UsbPort>> open_first_falcon();

/// Whether the Falcon on a port runs its firmware: asked with packets of no force, a tenth of a second at
/// most.
bool runs_firmware(std::unique_ptr<UsbPort> port);

/// The Novint Falcon: three forces at a grip that has no orientation of its own, so the tool keeps `start`'s.
/// open() claims the device and returns; loading and homing go on in the device's own thread, seen in the
/// samples' state and in guidance(). That thread alone talks to the bus, sends the newest motor values at
/// about 1–2 kHz, and sends zero whenever the control loop has been silent for 20 ms. Unplugged: state
/// kOpening and no force until it is back, loaded and homed anew. Encoders that jump, homing that takes too
/// long and firmware that doesn't load are faults. Errors: kBadValue for the firmware file or settings;
/// open(): kNoDevice as UsbPort::open.
Result<std::unique_ptr<HapticDevice>> make_falcon(const FalconSettings& settings, const Pose& start,
                                                  OpenPort open_port = open_first_falcon);

}  // namespace palpate::falcon

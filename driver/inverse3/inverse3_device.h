#pragma once
#include <cstdint>
#include <memory>

#include "driver/haptic_device.h"
#include "driver/workspace.h"

namespace palpate::inverse3 {

/// Where the maker's service listens.
inline constexpr std::uint16_t kServicePort = 10001;

struct Inverse3Settings {
  std::uint16_t port = kServicePort;  ///< on this machine
  double max_force_n = 5;             ///< a limit of ours: the service tells no rating
  WorkspaceSettings workspace{};
};

/// The Haply Inverse3: three forces at a handle, through its maker's service (JSON over a WebSocket). With a
/// VerseGrip the tool turns with the grip, from the start pose's rotation on; without one it keeps that.
/// open() connects; states and forces go through a thread of the device's own. Service or arm gone: state
/// kOpening and no force until they are back. An arm that isn't ready, powered and calibrated: kHoming.
/// open() errors: kNoDevice, no service, or none with an Inverse3.
std::unique_ptr<HapticDevice> make_inverse3(const Inverse3Settings& settings, const Pose& start);

}  // namespace palpate::inverse3

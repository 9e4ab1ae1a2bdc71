#pragma once
#include <array>
#include <cstdint>
#include <span>

#include "driver/usb_port.h"

/// 3Dconnexion's six-axis mice: interrupt reports of a HID interface. Report 1 carries x, y, z as int16
/// (newer models: and the rotations), 2 the rotations on older ones, 3 the buttons. Full deflection is about
/// ±350.
namespace palpate::spacemouse {

/// Every model known to speak so.
inline constexpr std::array<UsbId, 11> kModels{{{0x046d, 0xc626},
                                                {0x046d, 0xc62b},
                                                {0x256f, 0xc62e},
                                                {0x256f, 0xc62f},
                                                {0x256f, 0xc631},
                                                {0x256f, 0xc632},
                                                {0x256f, 0xc633},
                                                {0x256f, 0xc635},
                                                {0x256f, 0xc638},
                                                {0x256f, 0xc63a},
                                                {0x256f, 0xc652}}};

inline constexpr std::int16_t kFullDeflection = 350;

/// What the cap says: axes x y z rx ry rz as the device counts them, within ±kFullDeflection.
struct Cap {
  std::array<std::int16_t, 6> axes{};
  std::uint32_t buttons = 0;
};

/// Takes one report into `cap`; what the report does not speak of stays. False, and nothing changed, where it
/// is no report: an unknown number or too few bytes. Deflections beyond full are cut to it.
bool take(std::span<const std::uint8_t> report, Cap& cap) noexcept;

}  // namespace palpate::spacemouse

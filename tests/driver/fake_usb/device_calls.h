#pragma once
#include <atomic>
#include <cstdint>
#include <functional>
#include <span>
#include <vector>

namespace palpate::fake {

/// What a device answers, by the front that carries it. Called with the front's lock held.
struct DeviceCalls {
  std::function<bool(std::uint8_t request, std::uint16_t value)> control;  ///< vendor request; false: stall
  std::function<void(std::span<const std::uint8_t>)> out;
  std::function<std::vector<std::uint8_t>()> in;  ///< one IN packet
  std::function<bool()> has_bytes;                ///< whether in() has more to say than an empty packet
  /// Class request with its data; empty: taken and forgotten.
  std::function<void(std::uint8_t request, std::uint16_t value, std::span<const std::uint8_t> data)>
      class_out{};
};

/// Faults of the bus rather than of the device.
struct BusFaults {
  std::atomic<int> stalled_in{0};  ///< so many IN transfers stall
  std::atomic<int> stalled_out{0};
  std::atomic<int> stalled_control{0};  ///< so many vendor requests are refused
  std::atomic<int> babble{0};           ///< so many IN transfers overflow
  std::atomic<int> slow_us{0};          ///< every transfer takes so much longer
  std::atomic<int> unplug_in{0};        ///< after so many transfers the plug comes out; 0: never
  std::atomic<bool> deaf{false};        ///< OUT transfers are taken and never finish
  std::atomic<bool> busy{false};        ///< claiming fails: somebody else has the interface
  std::atomic<bool> kernel_driver{
      false};  ///< the kernel's own driver has the interface, until it is detached
};

/// The descriptors of a device with one interface of one bulk pair: OUT 0x02 and IN 0x81, 64 bytes.
std::vector<std::uint8_t> bulk_pair_descriptors(std::uint16_t vendor, std::uint16_t product);
/// Of a HID device with one interrupt endpoint: IN 0x81, 16 bytes.
std::vector<std::uint8_t> hid_descriptors(std::uint16_t vendor, std::uint16_t product);

}  // namespace palpate::fake

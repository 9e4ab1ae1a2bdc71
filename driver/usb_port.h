#pragma once
#include <chrono>
#include <cstdint>
#include <functional>
#include <memory>
#include <span>
#include <string>
#include <vector>

#include "model/result.h"

namespace palpate {

struct UsbId {
  std::uint16_t vendor = 0, product = 0;
  bool operator==(const UsbId&) const = default;
};

/// A USB device that is plugged in, as the system lists it.
struct UsbDeviceInfo {
  UsbId id;
  std::string place;  ///< bus and address, "1-4"; tells two devices of one model apart
  bool usable = false;
  bool kernel_driver = false;  ///< the kernel's own driver has it, which palpate takes it from for a run
  std::string reason;          ///< why it can't be used, one sentence with what to do; empty when usable
};

/// One claimed interface of a USB device: the only place of the project that knows libusb.
/// For a device's own thread, never for the 1 kHz loop: libusb allocates and locks. One thread uses a port at
/// a time. Once the device is gone every call fails with kNoDevice, and lost() says so.
class UsbPort {
 public:
  using Milliseconds = std::chrono::milliseconds;
  /// Takes what one IN transfer brought; called by pump() alone.
  using OnPacket = std::function<void(std::span<const std::uint8_t>)>;

  /// Claims `interface` of the first device plugged in whose id is among `ids`; the kernel's own driver is
  /// detached and comes back with close. Errors (kNoDevice): none is plugged in; no permission; claimed by
  /// somebody else.
  static Result<std::unique_ptr<UsbPort>> open(std::span<const UsbId> ids, int interface);
  /// The same for a usbfs descriptor that is open already: for systems that hand out descriptors, and for
  /// tests. The descriptor stays the caller's.
  static Result<std::unique_ptr<UsbPort>> open_descriptor(int descriptor, int interface);

  ~UsbPort();
  UsbPort(const UsbPort&) = delete;
  UsbPort& operator=(const UsbPort&) = delete;

  UsbId id() const;
  /// A control transfer towards the device, with at most 64 bytes of data.
  Result<void> control(std::uint8_t request_type, std::uint8_t request, std::uint16_t value,
                       std::uint16_t index, Milliseconds timeout, std::span<const std::uint8_t> data = {});
  /// Sends all bytes and waits until they are sent.
  Result<void> write(std::uint8_t endpoint, std::span<const std::uint8_t> bytes, Milliseconds timeout);

  /// Keeps IN transfers of `size` bytes posted on an endpoint (bulk, or interrupt) from now on; what they
  /// bring goes to `on_packet`. At most one endpoint a port.
  Result<void> listen(std::uint8_t endpoint, bool interrupt, std::size_t size, OnPacket on_packet);
  /// Begins to send bytes (at most 64) without waiting. False if the last ones are still on their way or the
  /// device is gone.
  bool send(std::uint8_t endpoint, std::span<const std::uint8_t> bytes);
  /// Handles what happened on the bus, waiting for something at most `timeout`.
  void pump(std::chrono::microseconds timeout);

  bool lost() const noexcept;
  std::uint64_t errors()
      const noexcept;  ///< transfers that failed without the device being gone: stall, babble, protocol

 private:
  struct State;
  explicit UsbPort(std::unique_ptr<State> state);
  std::unique_ptr<State> state_;
};

/// The devices plugged in whose id is among `ids`, each tried for access: opened, its first interface claimed
/// and released at once. The kernel's own driver is left where it is. Error: libusb does not start.
Result<std::vector<UsbDeviceInfo>> list_usb_devices(std::span<const UsbId> ids);

}  // namespace palpate

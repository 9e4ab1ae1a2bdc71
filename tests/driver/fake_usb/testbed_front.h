#pragma once
#include <umockdev.h>

#include <chrono>
#include <cstdint>
#include <deque>
#include <mutex>
#include <string>
#include <vector>

#include "tests/driver/fake_usb/device_calls.h"

namespace palpate::fake {

/// A USB bus of its own, which programs started by this one see instead of the system's: sysfs, device nodes,
/// hot-plug messages. This program must run with umockdev's library preloaded; one at a time.
class Testbed {
 public:
  Testbed() : bed_(umockdev_testbed_new()) {}
  ~Testbed() { g_object_unref(bed_); }
  Testbed(const Testbed&) = delete;
  Testbed& operator=(const Testbed&) = delete;
  UMockdevTestbed* get() const { return bed_; }
  std::string root() const;

 private:
  UMockdevTestbed* bed_;
};

/// A USB device on a testbed's bus: whatever program opens it through libusb talks to `calls`. Its transfers
/// are answered when they are asked for (poll is always ready there), so it is no judge of time.
class TestbedFront {
 public:
  /// Plugs the device in at an address of bus 1 that was not used before.
  TestbedFront(Testbed& testbed, DeviceCalls calls, const std::vector<std::uint8_t>& descriptors,
               int address);
  ~TestbedFront();
  TestbedFront(const TestbedFront&) = delete;
  TestbedFront& operator=(const TestbedFront&) = delete;

  void unplug();
  BusFaults faults;
  const std::string& node() const { return node_; }  ///< "/dev/bus/usb/001/004"
  /// OUT transfers that a program tried to send after the device was unplugged.
  std::vector<std::vector<std::uint8_t>> sent_too_late();

  /// Runs something with the device's calls shut out: for looking into a model.
  template <class F>
  auto locked(F&& look) {
    const std::lock_guard lock(mutex_);
    return look();
  }

 private:
  /// One transfer of the client: its block, and the buffer that it points to, both copies until they are
  /// written back.
  struct Urb {
    UMockdevIoctlData* block;
    UMockdevIoctlData* buffer;
    int status;
  };
  static gboolean on_ioctl(UMockdevIoctlBase* handler, UMockdevIoctlClient* client, gpointer self);
  static void on_vanished(UMockdevIoctlBase* handler, UMockdevIoctlClient* client, gpointer self);
  void answer(UMockdevIoctlClient* client);
  int submit(UMockdevIoctlData* arg);
  int reap(UMockdevIoctlData* arg);
  int discard(UMockdevIoctlData* arg);
  void bring_in();
  void forget();

  Testbed& testbed_;
  DeviceCalls calls_;
  UMockdevIoctlBase* handler_;
  std::string node_, syspath_;
  std::mutex mutex_;
  std::deque<Urb> waiting_in_, finished_;
  std::vector<std::vector<std::uint8_t>> too_late_;
  std::chrono::steady_clock::time_point last_in_{};
  bool gone_ = false;
};

}  // namespace palpate::fake

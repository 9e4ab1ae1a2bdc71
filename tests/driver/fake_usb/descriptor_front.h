#pragma once
#include <atomic>
#include <chrono>
#include <condition_variable>
#include <cstdint>
#include <deque>
#include <mutex>
#include <span>
#include <thread>
#include <vector>

#include "tests/driver/fake_usb/device_calls.h"

namespace palpate::fake {

/// A USB device behind a descriptor of this process: the unmodified libusb talks to it, since this program
/// defines ioctl, read and lseek itself and hands all other descriptors on to the system. Readiness is a
/// pipe's: full while nothing waits, emptied when a transfer is done, its other end closed when the device is
/// unplugged.
class DescriptorFront {
 public:
  DescriptorFront(DeviceCalls calls, std::vector<std::uint8_t> descriptors);
  ~DescriptorFront();
  DescriptorFront(const DescriptorFront&) = delete;
  DescriptorFront& operator=(const DescriptorFront&) = delete;

  int descriptor() const { return device_end_; }
  void unplug();
  BusFaults faults;
  int claims() const { return claims_; }

  /// Runs something with the device's calls shut out: for looking into a model.
  template <class F>
  auto locked(F&& look) {
    const std::lock_guard lock(mutex_);
    return look();
  }

  // For the system calls below.
  int handle_ioctl(unsigned long request, void* argument);
  long handle_read(void* to, std::size_t size);
  long handle_seek(long offset);
  static DescriptorFront* of(int descriptor);

 private:
  struct Finished {
    void* urb;
    int status;
  };
  void pull();
  bool pulled();
  int submit(void* urb);
  int reap(void** urb);
  int discard(void* urb);
  void finish(void* urb, int status);
  void run();
  void deliver();

  DeviceCalls calls_;
  std::vector<std::uint8_t> descriptors_;
  std::size_t at_ = 0;
  int device_end_ = -1, other_end_ = -1;
  std::mutex mutex_;
  std::deque<void*> waiting_in_, waiting_out_;
  std::deque<Finished> finished_;
  std::chrono::steady_clock::time_point last_in_{};
  bool gone_ = false, stop_ = false;
  std::atomic<int> claims_{0};
  std::thread thread_;
};

}  // namespace palpate::fake

#include "tests/driver/fake_usb/descriptor_front.h"

#include <fcntl.h>
#include <linux/usbdevice_fs.h>
#include <sys/ioctl.h>
#include <sys/syscall.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <cstdarg>
#include <cstring>
#include <map>

namespace palpate::fake {
namespace {

std::mutex fronts_mutex;
std::map<int, DescriptorFront*>& fronts() {
  static std::map<int, DescriptorFront*> all;
  return all;
}

void fill(int descriptor) {
  const std::array<char, 4096> zeros{};
  while (::write(descriptor, zeros.data(), zeros.size()) > 0) {
  }
}

void drain(int descriptor) {
  std::array<char, 4096> bytes;
  while (::syscall(SYS_read, descriptor, bytes.data(), bytes.size()) > 0) {
  }
}

constexpr auto kStep = std::chrono::microseconds(100);
constexpr auto kStatusEvery = std::chrono::milliseconds(1);  // the serial chip's latency timer

}  // namespace

DescriptorFront::DescriptorFront(DeviceCalls calls, std::vector<std::uint8_t> descriptors)
    : calls_(std::move(calls)), descriptors_(std::move(descriptors)) {
  std::array<int, 2> ends{};
  if (::pipe2(ends.data(), O_NONBLOCK | O_CLOEXEC) != 0) throw std::runtime_error("pipe2 failed");
  other_end_ = ends[0];
  device_end_ = ends[1];
  ::fcntl(device_end_, F_SETPIPE_SZ, 4096);
  fill(device_end_);
  {
    const std::lock_guard lock(fronts_mutex);
    fronts()[device_end_] = this;
  }
  thread_ = std::thread([this] { run(); });
}

DescriptorFront::~DescriptorFront() {
  {
    const std::lock_guard lock(mutex_);
    stop_ = true;
  }
  thread_.join();
  {
    const std::lock_guard lock(fronts_mutex);
    fronts().erase(device_end_);
  }
  ::close(device_end_);
  if (other_end_ >= 0) ::close(other_end_);
}

DescriptorFront* DescriptorFront::of(int descriptor) {
  const std::lock_guard lock(fronts_mutex);
  const auto found = fronts().find(descriptor);
  return found == fronts().end() ? nullptr : found->second;
}

void DescriptorFront::unplug() {
  const std::lock_guard lock(mutex_);
  pull();
}

/// Counts a transfer towards the one at which the plug comes out. True once it is out.
bool DescriptorFront::pulled() {
  if (!gone_ && faults.unplug_in > 0 && --faults.unplug_in == 0) pull();
  return gone_;
}

void DescriptorFront::pull() {
  if (gone_) return;
  gone_ = true;
  for (std::deque<void*>* waiting : {&waiting_in_, &waiting_out_})
    for (; !waiting->empty(); waiting->pop_front()) finished_.push_back({waiting->front(), -ENODEV});
  drain(other_end_);
  ::close(other_end_);
  other_end_ = -1;
}

void DescriptorFront::finish(void* urb, int status) {
  finished_.push_back({urb, status});
  if (other_end_ >= 0) drain(other_end_);
}

/// Brings waiting IN transfers what the device says, and an empty packet when the latency timer runs out.
void DescriptorFront::deliver() {
  const auto now = std::chrono::steady_clock::now();
  while (!gone_ && !waiting_in_.empty() && (calls_.has_bytes() || now - last_in_ >= kStatusEvery)) {
    if (pulled()) return;
    last_in_ = now;
    auto* urb = static_cast<usbdevfs_urb*>(waiting_in_.front());
    waiting_in_.pop_front();
    if (faults.stalled_in > 0) {
      --faults.stalled_in;
      finish(urb, -EPIPE);
      continue;
    }
    if (faults.babble > 0) {
      --faults.babble;
      finish(urb, -EOVERFLOW);
      continue;
    }
    const std::vector<std::uint8_t> packet = calls_.in();
    const std::size_t size = std::min(packet.size(), static_cast<std::size_t>(urb->buffer_length));
    if (size > 0) std::memcpy(urb->buffer, packet.data(), size);  // an empty vector has no address
    urb->actual_length = static_cast<int>(size);
    finish(urb, 0);
  }
}

void DescriptorFront::run() {
  while (true) {
    std::this_thread::sleep_for(kStep + std::chrono::microseconds(faults.slow_us.load()));
    const std::lock_guard lock(mutex_);
    if (stop_) return;
    deliver();
  }
}

int DescriptorFront::submit(void* argument) {
  if (pulled()) return -ENODEV;
  auto* urb = static_cast<usbdevfs_urb*>(argument);
  urb->actual_length = 0;
  if (urb->type == USBDEVFS_URB_TYPE_CONTROL) {
    const auto* setup = static_cast<const std::uint8_t*>(urb->buffer);
    if ((setup[0] & 0x60) == 0x20 && calls_.class_out)
      calls_.class_out(setup[1], static_cast<std::uint16_t>(setup[2] | (setup[3] << 8)),
                       {setup + 8, static_cast<std::size_t>(urb->buffer_length) - 8});
    if ((setup[0] & 0x60) !=
        0x40) {  // standard requests: the system answers them for a device; nothing depends on them here
      finish(urb, 0);
      return 0;
    }
    if (faults.stalled_control > 0) {
      --faults.stalled_control;
      finish(urb, -EPIPE);
      return 0;
    }
    const bool good = calls_.control(setup[1], static_cast<std::uint16_t>(setup[2] | (setup[3] << 8)));
    finish(urb, good ? 0 : -EPIPE);
    return 0;
  }
  if ((urb->endpoint & 0x80) != 0) {
    waiting_in_.push_back(urb);
    return 0;
  }
  if (faults.deaf) {
    waiting_out_.push_back(urb);
    return 0;
  }
  if (faults.stalled_out > 0) {
    --faults.stalled_out;
    finish(urb, -EPIPE);
    return 0;
  }
  calls_.out({static_cast<const std::uint8_t*>(urb->buffer), static_cast<std::size_t>(urb->buffer_length)});
  urb->actual_length = urb->buffer_length;
  finish(urb, 0);
  if (faults.slow_us == 0) deliver();  // a device that answers at once, so that what is measured is the host
  return 0;
}

int DescriptorFront::reap(void** urb) {
  if (finished_.empty()) {
    if (gone_) return -ENODEV;
    fill(device_end_);
    return -EAGAIN;
  }
  auto* done = static_cast<usbdevfs_urb*>(finished_.front().urb);
  done->status = finished_.front().status;
  finished_.pop_front();
  *urb = done;
  if (finished_.empty() && !gone_) fill(device_end_);
  return 0;
}

int DescriptorFront::discard(void* urb) {
  for (std::deque<void*>* waiting : {&waiting_in_, &waiting_out_}) {
    const auto found = std::find(waiting->begin(), waiting->end(), urb);
    if (found == waiting->end()) continue;
    waiting->erase(found);
    finish(urb, -ENOENT);
    return 0;
  }
  return -EINVAL;
}

int DescriptorFront::handle_ioctl(unsigned long request, void* argument) {
  const std::lock_guard lock(mutex_);
  if (gone_ && request != USBDEVFS_REAPURBNDELAY && request != USBDEVFS_DISCARDURB) return -ENODEV;
  switch (request) {
    case USBDEVFS_GET_CAPABILITIES:
      *static_cast<std::uint32_t*>(argument) = USBDEVFS_CAP_ZERO_PACKET | USBDEVFS_CAP_REAP_AFTER_DISCONNECT;
      return 0;
    case USBDEVFS_CONNECTINFO:
      *static_cast<usbdevfs_connectinfo*>(argument) = {.devnum = 7, .slow = 0};
      return 0;
    case USBDEVFS_GET_SPEED:
      return 3;
    case USBDEVFS_CONTROL: {  // the system's own: which configuration is active
      auto* transfer = static_cast<usbdevfs_ctrltransfer*>(argument);
      if (transfer->bRequest == 8 && transfer->wLength >= 1) {
        *static_cast<std::uint8_t*>(transfer->data) = 1;
        return 1;
      }
      return -EPIPE;
    }
    case USBDEVFS_GETDRIVER:
    case USBDEVFS_IOCTL:
      return -ENODATA;
    case USBDEVFS_CLAIMINTERFACE:
      if (faults.busy) return -EBUSY;
      ++claims_;
      return 0;
    case USBDEVFS_RELEASEINTERFACE:
    case USBDEVFS_CLEAR_HALT:
      return 0;
    case USBDEVFS_SUBMITURB:
      return submit(argument);
    case USBDEVFS_REAPURB:
    case USBDEVFS_REAPURBNDELAY:
      return reap(static_cast<void**>(argument));
    case USBDEVFS_DISCARDURB:
      return discard(argument);
    default:
      return -ENOTTY;
  }
}

long DescriptorFront::handle_read(void* to, std::size_t size) {
  const std::lock_guard lock(mutex_);
  const std::size_t count = std::min(size, descriptors_.size() - at_);
  std::memcpy(to, descriptors_.data() + at_, count);
  at_ += count;
  return static_cast<long>(count);
}

long DescriptorFront::handle_seek(long offset) {
  const std::lock_guard lock(mutex_);
  at_ = std::min(static_cast<std::size_t>(std::max(offset, 0L)), descriptors_.size());
  return static_cast<long>(at_);
}

}  // namespace palpate::fake

namespace {
int result_of(long value) {
  if (value >= 0) return static_cast<int>(value);
  errno = static_cast<int>(-value);
  return -1;
}
}  // namespace

// What libusb calls, and the C library's other users too: descriptors that are no front's go to the system.
extern "C" int ioctl(int descriptor, unsigned long request, ...) {
  va_list arguments;
  va_start(arguments, request);
  void* argument = va_arg(arguments, void*);
  va_end(arguments);
  if (auto* front = palpate::fake::DescriptorFront::of(descriptor))
    return result_of(front->handle_ioctl(request, argument));
  return static_cast<int>(::syscall(SYS_ioctl, descriptor, request, argument));
}

extern "C" ssize_t read(int descriptor, void* to, size_t size) {
  if (auto* front = palpate::fake::DescriptorFront::of(descriptor)) return front->handle_read(to, size);
  return ::syscall(SYS_read, descriptor, to, size);
}

extern "C" off_t lseek(int descriptor, off_t offset, int whence) noexcept {
  if (auto* front = palpate::fake::DescriptorFront::of(descriptor)) return front->handle_seek(offset);
  return ::syscall(SYS_lseek, descriptor, offset, whence);
}

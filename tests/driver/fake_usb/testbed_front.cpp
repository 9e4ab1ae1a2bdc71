#include "tests/driver/fake_usb/testbed_front.h"

#include <linux/usbdevice_fs.h>
#include <sys/ioctl.h>

#include <algorithm>
#include <cerrno>
#include <cstddef>
#include <cstdio>
#include <cstring>
#include <stdexcept>
#include <thread>

namespace palpate::fake {
namespace {

constexpr auto kStatusEvery = std::chrono::milliseconds(1);  // the serial chip's latency timer
constexpr auto kIdle = std::chrono::microseconds(200);       // nothing to reap: don't let the client spin

usbdevfs_urb& urb_in(UMockdevIoctlData* block) { return *reinterpret_cast<usbdevfs_urb*>(block->data); }

/// Copies a value into a block of the client's, to be written back when the call ends.
void put(UMockdevIoctlData* block, std::size_t offset, const void* bytes, std::size_t size) {
  std::vector<guint8> copy(size);
  if (size == 0) return;
  std::memcpy(copy.data(), bytes, size);
  umockdev_ioctl_data_update(block, offset, copy.data(), static_cast<gint>(size));
}

UMockdevIoctlData* resolved(UMockdevIoctlData* data, std::size_t offset, std::size_t size) {
  GError* error = nullptr;
  UMockdevIoctlData* found = umockdev_ioctl_data_resolve(data, offset, size, &error);
  if (error) g_error_free(error);
  return found;
}

}  // namespace

std::string Testbed::root() const {
  gchar* root = umockdev_testbed_get_root_dir(bed_);
  std::string text = root;
  g_free(root);
  return text;
}

TestbedFront::TestbedFront(Testbed& testbed, DeviceCalls calls, const std::vector<std::uint8_t>& descriptors,
                           int address)
    : testbed_(testbed), calls_(std::move(calls)), handler_(umockdev_ioctl_base_new()) {
  char text[64];
  std::snprintf(text, sizeof text, "/dev/bus/usb/001/%03d", address);
  node_ = text;
  const std::string name = "/devices/pci0000:00/0000:00:14.0/usb1/1-" + std::to_string(address);
  g_signal_connect(handler_, "handle-ioctl", G_CALLBACK(on_ioctl), this);
  g_signal_connect(handler_, "client-vanished", G_CALLBACK(on_vanished), this);
  // The handler first: a program that hears of the device opens it at once.
  GError* error = nullptr;
  if (!umockdev_testbed_attach_ioctl(testbed_.get(), node_.c_str(), handler_, &error))
    throw std::runtime_error(std::string("umockdev: ") + (error ? error->message : "attach_ioctl failed"));
  std::string hex;
  for (const std::uint8_t byte : descriptors) {
    std::snprintf(text, sizeof text, "%02X", byte);
    hex += text;
  }
  const std::string about =
      "P: " + name + "\nN: bus/usb/001/" + node_.substr(node_.size() - 3) + "\nE: DEVNAME=" + node_ +
      "\nE: DEVTYPE=usb_device\nE: SUBSYSTEM=usb\nE: BUSNUM=001\nE: DEVNUM=" +
      node_.substr(node_.size() - 3) + "\nA: busnum=1\\n\nA: devnum=" + std::to_string(address) +
      "\\n\nA: bConfigurationValue=1\\n\nA: speed=12\\n\nH: descriptors=" + hex + "\n";
  if (!umockdev_testbed_add_from_string(testbed_.get(), about.c_str(), &error))
    throw std::runtime_error(std::string("umockdev: ") + (error ? error->message : "add_from_string failed"));
  syspath_ = "/sys" + name;
  umockdev_testbed_uevent(testbed_.get(), syspath_.c_str(), "add");
}

TestbedFront::~TestbedFront() {
  unplug();
  g_signal_handlers_disconnect_by_data(handler_, this);
  umockdev_testbed_detach_ioctl(testbed_.get(), node_.c_str(), nullptr);
  g_object_unref(handler_);
  const std::lock_guard lock(mutex_);
  forget();
}

void TestbedFront::unplug() {
  {
    const std::lock_guard lock(mutex_);
    if (gone_) return;
    gone_ = true;
    for (; !waiting_in_.empty(); waiting_in_.pop_front()) {
      waiting_in_.front().status = -ENODEV;
      finished_.push_back(waiting_in_.front());
    }
  }
  umockdev_testbed_uevent(testbed_.get(), syspath_.c_str(), "remove");
  umockdev_testbed_remove_device(testbed_.get(), syspath_.c_str());
}

std::vector<std::vector<std::uint8_t>> TestbedFront::sent_too_late() {
  const std::lock_guard lock(mutex_);
  return too_late_;
}

void TestbedFront::forget() {
  for (std::deque<Urb>* urbs : {&waiting_in_, &finished_}) {
    for (const Urb& urb : *urbs) {
      if (urb.buffer) umockdev_ioctl_data_unref(urb.buffer);
      umockdev_ioctl_data_unref(urb.block);
    }
    urbs->clear();
  }
}

void TestbedFront::on_vanished(UMockdevIoctlBase*, UMockdevIoctlClient*, gpointer self) {
  auto& front = *static_cast<TestbedFront*>(self);
  const std::lock_guard lock(front.mutex_);
  front.forget();
}

gboolean TestbedFront::on_ioctl(UMockdevIoctlBase*, UMockdevIoctlClient* client, gpointer self) {
  static_cast<TestbedFront*>(self)->answer(client);
  return TRUE;
}

void TestbedFront::answer(UMockdevIoctlClient* client) {
  int result = 0;  // ≥ 0, or −errno
  {
    const std::lock_guard lock(mutex_);
    UMockdevIoctlData* arg = umockdev_ioctl_client_get_arg(client);
    const gulong request = umockdev_ioctl_client_get_request(client);
    if (gone_ && request == USBDEVFS_SUBMITURB) {
      (void)submit(arg);
      result = -ENODEV;
    } else if (gone_ && request != USBDEVFS_REAPURBNDELAY && request != USBDEVFS_DISCARDURB) {
      result = -ENODEV;
    } else {
      switch (request) {
        case USBDEVFS_GET_CAPABILITIES: {
          UMockdevIoctlData* word = resolved(arg, 0, sizeof(std::uint32_t));
          const std::uint32_t can = USBDEVFS_CAP_ZERO_PACKET | USBDEVFS_CAP_REAP_AFTER_DISCONNECT;
          put(word, 0, &can, sizeof can);
          umockdev_ioctl_data_unref(word);
          break;
        }
        case USBDEVFS_GETDRIVER: {
          if (!faults.kernel_driver) {
            result = -ENODATA;
            break;
          }
          UMockdevIoctlData* block = resolved(arg, 0, sizeof(usbdevfs_getdriver));
          usbdevfs_getdriver driver{};
          std::strcpy(driver.driver, "usbhid");
          put(block, 0, &driver, sizeof driver);
          umockdev_ioctl_data_unref(block);
          break;
        }
        case USBDEVFS_IOCTL: {
          UMockdevIoctlData* block = resolved(arg, 0, sizeof(usbdevfs_ioctl));
          const int wanted = reinterpret_cast<const usbdevfs_ioctl*>(block->data)->ioctl_code;
          if (wanted == static_cast<int>(USBDEVFS_DISCONNECT)) {
            result = faults.kernel_driver ? 0 : -ENODATA;
            faults.kernel_driver = false;
          }
          umockdev_ioctl_data_unref(block);
          break;
        }
        case USBDEVFS_CLAIMINTERFACE:
          result = faults.busy || faults.kernel_driver ? -EBUSY : 0;
          break;
        case USBDEVFS_RELEASEINTERFACE:
        case USBDEVFS_CLEAR_HALT:
        case USBDEVFS_RESET:
          break;
        case USBDEVFS_SUBMITURB:
          result = submit(arg);
          break;
        case USBDEVFS_REAPURB:
        case USBDEVFS_REAPURBNDELAY:
          result = reap(arg);
          break;
        case USBDEVFS_DISCARDURB:
          result = discard(arg);
          break;
        default:
          result = -ENOTTY;
      }
    }
  }
  if (result == -EAGAIN) std::this_thread::sleep_for(kIdle);
  umockdev_ioctl_client_complete(client, result < 0 ? -1 : result, result < 0 ? -result : 0);
}

int TestbedFront::submit(UMockdevIoctlData* arg) {
  UMockdevIoctlData* block = resolved(arg, 0, sizeof(usbdevfs_urb));
  if (!block) return -EFAULT;
  usbdevfs_urb& urb = urb_in(block);
  UMockdevIoctlData* buffer = urb.buffer_length > 0 ? resolved(block, offsetof(usbdevfs_urb, buffer),
                                                               static_cast<std::size_t>(urb.buffer_length))
                                                    : nullptr;
  urb.actual_length = 0;
  Urb kept{block, buffer, 0};
  const bool control = urb.type == USBDEVFS_URB_TYPE_CONTROL;
  const bool in = !control && (urb.endpoint & 0x80) != 0;
  if (gone_) {
    if (!control && !in && buffer) too_late_.emplace_back(buffer->data, buffer->data + buffer->data_len);
    if (buffer) umockdev_ioctl_data_unref(buffer);
    umockdev_ioctl_data_unref(block);
    return -ENODEV;
  }
  if (in) {
    waiting_in_.push_back(kept);
    return 0;
  }
  if (control) {
    const guint8* setup = buffer->data;
    if ((setup[0] & 0x60) == 0x40 &&
        !calls_.control(setup[1], static_cast<std::uint16_t>(setup[2] | (setup[3] << 8))))
      kept.status = -EPIPE;
  } else if (faults.stalled_out > 0) {
    --faults.stalled_out;
    kept.status = -EPIPE;
  } else {
    calls_.out({buffer->data, static_cast<std::size_t>(urb.buffer_length)});
    urb.actual_length = urb.buffer_length;
  }
  finished_.push_back(kept);
  return 0;
}

/// Gives the oldest waiting IN transfer what the device says, if it says something or the latency timer has
/// run out.
void TestbedFront::bring_in() {
  const auto now = std::chrono::steady_clock::now();
  if (waiting_in_.empty() || !(calls_.has_bytes() || now - last_in_ >= kStatusEvery)) return;
  last_in_ = now;
  Urb done = waiting_in_.front();
  waiting_in_.pop_front();
  if (faults.stalled_in > 0) {
    --faults.stalled_in;
    done.status = -EPIPE;
  } else if (faults.babble > 0) {
    --faults.babble;
    done.status = -EOVERFLOW;
  } else {
    const std::vector<std::uint8_t> packet = calls_.in();
    const std::size_t size =
        std::min(packet.size(), static_cast<std::size_t>(urb_in(done.block).buffer_length));
    put(done.buffer, 0, packet.data(), size);
    urb_in(done.block).actual_length = static_cast<int>(size);
  }
  finished_.push_back(done);
}

int TestbedFront::reap(UMockdevIoctlData* arg) {
  if (finished_.empty() && !gone_) bring_in();
  if (finished_.empty()) return gone_ ? -ENODEV : -EAGAIN;
  const Urb done = finished_.front();
  finished_.pop_front();
  urb_in(done.block).status = done.status;
  UMockdevIoctlData* pointer = resolved(arg, 0, sizeof(void*));
  umockdev_ioctl_data_set_ptr(pointer, 0, done.block);
  umockdev_ioctl_data_unref(pointer);
  if (done.buffer) umockdev_ioctl_data_unref(done.buffer);
  umockdev_ioctl_data_unref(done.block);
  return 0;
}

int TestbedFront::discard(UMockdevIoctlData* arg) {
  gulong address = 0;
  std::memcpy(&address, arg->data,
              sizeof address);  // never resolved: the call's argument is the client's own pointer
  const auto found = std::find_if(waiting_in_.begin(), waiting_in_.end(),
                                  [&](const Urb& urb) { return urb.block->client_addr == address; });
  if (found == waiting_in_.end()) return gone_ ? -ENODEV : -EINVAL;
  found->status = -ENOENT;
  finished_.push_back(*found);
  waiting_in_.erase(found);
  return 0;
}

}  // namespace palpate::fake

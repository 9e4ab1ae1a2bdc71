#include "driver/usb_port.h"

#include <libusb-1.0/libusb.h>

#include <algorithm>
#include <array>
#include <cstring>

namespace palpate {
namespace {

constexpr int kInTransfers = 4;  // so that one is always posted while the others are being handled
constexpr std::size_t kSendBytes = 64;
constexpr int kErrorsInARow = 16;  // transfers failing one after the other: the device is as good as gone

struct ContextDeleter {
  void operator()(libusb_context* context) const { libusb_exit(context); }
};
using Context = std::unique_ptr<libusb_context, ContextDeleter>;

struct HandleDeleter {
  void operator()(libusb_device_handle* handle) const { libusb_close(handle); }
};
using Handle = std::unique_ptr<libusb_device_handle, HandleDeleter>;

struct TransferDeleter {
  void operator()(libusb_transfer* transfer) const { libusb_free_transfer(transfer); }
};
using Transfer = std::unique_ptr<libusb_transfer, TransferDeleter>;

Error no_device(std::string sentence) { return {ErrorCode::kNoDevice, std::move(sentence)}; }

std::string hex(std::uint16_t value) {
  constexpr char digits[] = "0123456789abcdef";
  std::string text(4, '0');
  for (unsigned i = 0; i < 4; ++i) text[3 - i] = digits[(value >> (4 * i)) & 0xF];
  return text;
}

std::string name_of(UsbId id) { return hex(id.vendor) + ":" + hex(id.product); }

/// What a libusb error means to whoever plugged the device in.
std::string meaning(int error, UsbId id) {
  switch (error) {
    case LIBUSB_ERROR_ACCESS:
      return "USB device " + name_of(id) +
             " may not be opened by this user: install 70-palpate.rules (in driver/udev, or a bundle's "
             "share/palpate) and plug it in again";
    case LIBUSB_ERROR_BUSY:
      return "USB device " + name_of(id) + " is in use by another program";
    case LIBUSB_ERROR_NO_DEVICE:
      return "USB device " + name_of(id) + " was unplugged";
    case LIBUSB_ERROR_TIMEOUT:
      return "USB device " + name_of(id) + " did not answer in time";
    case LIBUSB_ERROR_PIPE:
      return "USB device " + name_of(id) + " refused a request (stall)";
    default:
      return "USB device " + name_of(id) + ": " + libusb_strerror(static_cast<libusb_error>(error));
  }
}

Result<Context> make_context(bool discovery) {
  if (!discovery) {
    if (const int error = libusb_set_option(nullptr, LIBUSB_OPTION_NO_DEVICE_DISCOVERY);
        error != LIBUSB_SUCCESS)
      return no_device(std::string("libusb can't open a descriptor: ") +
                       libusb_strerror(static_cast<libusb_error>(error)));
  }
  libusb_context* context = nullptr;
  if (const int error = libusb_init(&context); error != LIBUSB_SUCCESS)
    return no_device(std::string("libusb does not start: ") +
                     libusb_strerror(static_cast<libusb_error>(error)));
  return Context(context);
}

/// The devices plugged in, for as long as it lives.
class DeviceList {
 public:
  explicit DeviceList(libusb_context* context) { size_ = libusb_get_device_list(context, &list_); }
  ~DeviceList() {
    if (size_ >= 0) libusb_free_device_list(list_, 1);
  }
  DeviceList(const DeviceList&) = delete;
  DeviceList& operator=(const DeviceList&) = delete;
  std::span<libusb_device*> devices() const {
    return {list_, size_ < 0 ? 0 : static_cast<std::size_t>(size_)};
  }

 private:
  libusb_device** list_ = nullptr;
  ssize_t size_ = 0;
};

bool wanted(libusb_device* device, std::span<const UsbId> ids, UsbId& id) {
  libusb_device_descriptor descriptor{};
  if (libusb_get_device_descriptor(device, &descriptor) != LIBUSB_SUCCESS) return false;
  id = {descriptor.idVendor, descriptor.idProduct};
  return std::find(ids.begin(), ids.end(), id) != ids.end();
}

int milliseconds(UsbPort::Milliseconds time) {
  return static_cast<int>(std::max<std::int64_t>(time.count(), 1));
}

}  // namespace

struct UsbPort::State {
  Context context;
  Handle handle;
  int interface = -1;
  bool claimed = false;
  UsbId id;
  OnPacket on_packet;
  std::array<Transfer, kInTransfers> in;
  std::array<std::vector<std::uint8_t>, kInTransfers> in_bytes;
  Transfer out;
  std::array<std::uint8_t, kSendBytes> out_bytes{};
  int in_flight = 0;  // IN transfers posted
  bool out_in_flight = false;
  bool closing = false, gone = false;
  int errors_in_a_row = 0;
  std::uint64_t error_count = 0;

  ~State() {
    closing = true;
    for (const Transfer& transfer : in)
      if (transfer) libusb_cancel_transfer(transfer.get());
    if (out_in_flight) libusb_cancel_transfer(out.get());
    // A transfer may be freed only when it has come back. Cancelled ones come back at once unless the kernel
    // is stuck; then the memory is left alone rather than freed under the kernel's hands.
    for (int tries = 0; (in_flight > 0 || out_in_flight) && tries < 100; ++tries) {
      timeval wait{0, 10'000};
      libusb_handle_events_timeout_completed(context.get(), &wait, nullptr);
    }
    if (in_flight > 0 || out_in_flight) {
      for (Transfer& transfer : in) (void)transfer.release();
      (void)out.release();
    }
    if (claimed) {
      libusb_release_interface(handle.get(), interface);
      libusb_attach_kernel_driver(handle.get(),
                                  interface);  // what open() detached; an error only says there was none
    }
  }

  Error failed(int error) {
    if (error == LIBUSB_ERROR_NO_DEVICE) gone = true;
    return no_device(meaning(error, id));
  }

  /// What a finished transfer says about the device.
  void judge(libusb_transfer_status status) {
    if (status == LIBUSB_TRANSFER_COMPLETED || status == LIBUSB_TRANSFER_TIMED_OUT) {
      errors_in_a_row = 0;
    } else if (status == LIBUSB_TRANSFER_NO_DEVICE) {
      gone = true;
    } else if (status != LIBUSB_TRANSFER_CANCELLED) {
      ++error_count;
      if (++errors_in_a_row >= kErrorsInARow) gone = true;
    }
  }

  static void LIBUSB_CALL in_done(libusb_transfer* transfer) {
    State& state = *static_cast<State*>(transfer->user_data);
    --state.in_flight;
    if (state.closing) return;
    state.judge(transfer->status);
    // A transfer that failed may have brought bytes all the same.
    if (transfer->actual_length > 0)
      state.on_packet({transfer->buffer, static_cast<std::size_t>(transfer->actual_length)});
    if (state.gone || transfer->status == LIBUSB_TRANSFER_CANCELLED) return;
    if (transfer->status == LIBUSB_TRANSFER_STALL) state.stalled = true;
    if (libusb_submit_transfer(transfer) == LIBUSB_SUCCESS)
      ++state.in_flight;
    else
      state.gone = true;
  }

  static void LIBUSB_CALL out_done(libusb_transfer* transfer) {
    State& state = *static_cast<State*>(transfer->user_data);
    state.out_in_flight = false;
    if (!state.closing) state.judge(transfer->status);
  }

  bool stalled = false;  // the IN endpoint's halt is to be cleared, outside the callback
  std::uint8_t in_endpoint = 0;
};

UsbPort::UsbPort(std::unique_ptr<State> state) : state_(std::move(state)) {}
UsbPort::~UsbPort() = default;

namespace {

Result<void> claim(libusb_device_handle* handle, int interface, UsbId id) {
  const int active = libusb_kernel_driver_active(handle, interface);
  if (active == 1)
    if (const int error = libusb_detach_kernel_driver(handle, interface);
        error != LIBUSB_SUCCESS && error != LIBUSB_ERROR_NOT_FOUND)
      return no_device("USB device " + name_of(id) + " is held by a kernel driver that can't be detached (" +
                       libusb_strerror(static_cast<libusb_error>(error)) + ")");
  if (const int error = libusb_claim_interface(handle, interface); error != LIBUSB_SUCCESS)
    return no_device(meaning(error, id));
  return {};
}

}  // namespace

Result<std::unique_ptr<UsbPort>> UsbPort::open(std::span<const UsbId> ids, int interface) {
  Result<Context> context = make_context(true);
  if (!context) return context.error();
  auto state = std::make_unique<State>();
  state->context = std::move(*context);
  state->interface = interface;
  {
    const DeviceList list(state->context.get());
    Error why = no_device("no such USB device is plugged in (" + [&] {
      std::string names;
      for (const UsbId id : ids) names += (names.empty() ? "" : ", ") + name_of(id);
      return names;
    }() + ")");
    for (libusb_device* device : list.devices()) {
      if (!wanted(device, ids, state->id)) continue;
      libusb_device_handle* handle = nullptr;
      if (const int error = libusb_open(device, &handle); error != LIBUSB_SUCCESS) {
        why = no_device(meaning(error, state->id));
        continue;
      }
      state->handle.reset(handle);
      if (auto claimed = claim(handle, interface, state->id); !claimed) {
        why = claimed.error();
        state->handle.reset();
        continue;
      }
      state->claimed = true;
      break;
    }
    if (!state->claimed) return why;
  }
  return std::unique_ptr<UsbPort>(new UsbPort(std::move(state)));
}

Result<std::unique_ptr<UsbPort>> UsbPort::open_descriptor(int descriptor, int interface) {
  Result<Context> context = make_context(false);
  if (!context) return context.error();
  auto state = std::make_unique<State>();
  state->context = std::move(*context);
  state->interface = interface;
  libusb_device_handle* handle = nullptr;
  if (const int error = libusb_wrap_sys_device(state->context.get(), descriptor, &handle);
      error != LIBUSB_SUCCESS)
    return no_device(std::string("the descriptor is no USB device: ") +
                     libusb_strerror(static_cast<libusb_error>(error)));
  state->handle.reset(handle);
  libusb_device_descriptor about{};
  if (libusb_get_device_descriptor(libusb_get_device(handle), &about) == LIBUSB_SUCCESS)
    state->id = {about.idVendor, about.idProduct};
  if (auto claimed = claim(handle, interface, state->id); !claimed) return claimed.error();
  state->claimed = true;
  return std::unique_ptr<UsbPort>(new UsbPort(std::move(state)));
}

UsbId UsbPort::id() const { return state_->id; }

Result<void> UsbPort::control(std::uint8_t request_type, std::uint8_t request, std::uint16_t value,
                              std::uint16_t index, Milliseconds timeout, std::span<const std::uint8_t> data) {
  if (state_->gone) return state_->failed(LIBUSB_ERROR_NO_DEVICE);
  std::array<std::uint8_t, kSendBytes> copy{};  // libusb asks for bytes that it could write to
  if (data.size() > copy.size())
    return Error{ErrorCode::kInternal, "a USB control transfer carries at most 64 bytes here"};
  std::copy(data.begin(), data.end(), copy.begin());
  const int done = libusb_control_transfer(state_->handle.get(), request_type, request, value, index,
                                           copy.data(), static_cast<std::uint16_t>(data.size()),
                                           static_cast<unsigned>(milliseconds(timeout)));
  if (done < 0) return state_->failed(done);
  return {};
}

Result<void> UsbPort::write(std::uint8_t endpoint, std::span<const std::uint8_t> bytes,
                            Milliseconds timeout) {
  if (state_->gone) return state_->failed(LIBUSB_ERROR_NO_DEVICE);
  std::vector<std::uint8_t> copy(bytes.begin(), bytes.end());  // libusb asks for bytes that it could write to
  int sent = 0;
  const int error =
      libusb_bulk_transfer(state_->handle.get(), endpoint, copy.data(), static_cast<int>(copy.size()), &sent,
                           static_cast<unsigned>(milliseconds(timeout)));
  if (error != LIBUSB_SUCCESS) return state_->failed(error);
  if (static_cast<std::size_t>(sent) != copy.size())
    return no_device("USB device " + name_of(state_->id) + " took " + std::to_string(sent) + " of " +
                     std::to_string(copy.size()) + " bytes");
  return {};
}

Result<void> UsbPort::listen(std::uint8_t endpoint, bool interrupt, std::size_t size, OnPacket on_packet) {
  if (state_->in_endpoint != 0) return Error{ErrorCode::kInternal, "a USB port listens to one endpoint only"};
  state_->in_endpoint = endpoint;
  state_->on_packet = std::move(on_packet);
  for (std::size_t i = 0; i < state_->in.size(); ++i) {
    state_->in[i].reset(libusb_alloc_transfer(0));
    if (!state_->in[i]) return Error{ErrorCode::kInternal, "no memory for USB transfers"};
    state_->in_bytes[i].resize(size);
    const auto fill = interrupt ? libusb_fill_interrupt_transfer : libusb_fill_bulk_transfer;
    fill(state_->in[i].get(), state_->handle.get(), endpoint, state_->in_bytes[i].data(),
         static_cast<int>(size), &State::in_done, state_.get(), 0);
    if (const int error = libusb_submit_transfer(state_->in[i].get()); error != LIBUSB_SUCCESS)
      return state_->failed(error);
    ++state_->in_flight;
  }
  return {};
}

bool UsbPort::send(std::uint8_t endpoint, std::span<const std::uint8_t> bytes) {
  State& state = *state_;
  if (state.gone || state.out_in_flight || bytes.size() > kSendBytes) return false;
  if (!state.out) state.out.reset(libusb_alloc_transfer(0));
  if (!state.out) return false;
  std::copy(bytes.begin(), bytes.end(), state.out_bytes.begin());
  // Time-out: a device that takes no bytes for 100 ms would otherwise keep the newest force from ever being
  // sent.
  libusb_fill_bulk_transfer(state.out.get(), state.handle.get(), endpoint, state.out_bytes.data(),
                            static_cast<int>(bytes.size()), &State::out_done, state_.get(), 100);
  const int error = libusb_submit_transfer(state.out.get());
  if (error != LIBUSB_SUCCESS) {
    if (error == LIBUSB_ERROR_NO_DEVICE) state.gone = true;
    return false;
  }
  state.out_in_flight = true;
  return true;
}

void UsbPort::pump(std::chrono::microseconds timeout) {
  State& state = *state_;
  timeval wait{static_cast<time_t>(timeout.count() / 1'000'000),
               static_cast<suseconds_t>(timeout.count() % 1'000'000)};
  const int error = libusb_handle_events_timeout_completed(state.context.get(), &wait, nullptr);
  if (error == LIBUSB_ERROR_NO_DEVICE) state.gone = true;
  if (state.stalled && !state.gone) {
    state.stalled = false;
    if (libusb_clear_halt(state.handle.get(), state.in_endpoint) == LIBUSB_ERROR_NO_DEVICE) state.gone = true;
  }
}

bool UsbPort::lost() const noexcept { return state_->gone; }

std::uint64_t UsbPort::errors() const noexcept { return state_->error_count; }

Result<std::vector<UsbDeviceInfo>> list_usb_devices(std::span<const UsbId> ids) {
  std::vector<UsbDeviceInfo> found;
  const Result<Context> context = make_context(true);
  if (!context) return context.error();
  const DeviceList list(context->get());
  for (libusb_device* device : list.devices()) {
    UsbDeviceInfo info;
    if (!wanted(device, ids, info.id)) continue;
    info.place = std::to_string(libusb_get_bus_number(device)) + "-" +
                 std::to_string(libusb_get_device_address(device));
    libusb_device_handle* handle = nullptr;
    const int error = libusb_open(device, &handle);
    if (error == LIBUSB_SUCCESS) {
      info.kernel_driver = libusb_kernel_driver_active(handle, 0) == 1;
      const int claimed = info.kernel_driver ? LIBUSB_SUCCESS : libusb_claim_interface(handle, 0);
      info.usable = claimed == LIBUSB_SUCCESS;
      if (!info.usable) info.reason = meaning(claimed, info.id);
      if (info.usable && !info.kernel_driver) libusb_release_interface(handle, 0);
      libusb_close(handle);
    } else {
      info.reason = meaning(error, info.id);
    }
    found.push_back(std::move(info));
  }
  return found;
}

}  // namespace palpate

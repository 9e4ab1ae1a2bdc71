#include "tests/driver/fake_usb/device_calls.h"

namespace palpate::fake {
namespace {

std::uint8_t low(std::uint16_t v) { return static_cast<std::uint8_t>(v & 0xFF); }
std::uint8_t high(std::uint16_t v) { return static_cast<std::uint8_t>(v >> 8); }

}  // namespace

std::vector<std::uint8_t> bulk_pair_descriptors(std::uint16_t vendor, std::uint16_t product) {
  return {18, 1, 0x00, 0x02, 0,  0,    0,    64,   low(vendor), high(vendor), low(product), high(product),
          0,  4, 0,    0,    0,  1,                     // device
          9,  2, 32,   0,    1,  1,    0,    0x80, 50,  // configuration
          9,  4, 0,    0,    2,  0xFF, 0xFF, 0xFF, 0,   // interface
          7,  5, 0x81, 2,    64, 0,    0,               // endpoints
          7,  5, 0x02, 2,    64, 0,    0};
}

std::vector<std::uint8_t> hid_descriptors(std::uint16_t vendor, std::uint16_t product) {
  return {18, 1,    0x00, 0x02, 0,  0, 0,    64,   low(vendor), high(vendor), low(product), high(product),
          0,  4,    0,    0,    0,  1,                  // device
          9,  2,    34,   0,    1,  1, 0,    0x80, 50,  // configuration
          9,  4,    0,    0,    1,  3, 0,    0,    0,   // interface
          9,  0x21, 0x11, 0x01, 0,  1, 0x22, 100,  0,   // HID
          7,  5,    0x81, 3,    16, 0, 8};              // endpoint
}

}  // namespace palpate::fake

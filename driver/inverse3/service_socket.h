#pragma once
#include <chrono>
#include <cstdint>
#include <memory>
#include <optional>
#include <string>

#include "model/result.h"

namespace palpate::inverse3 {

/// A WebSocket to the device's own service on this machine, in which no call waits longer than it is told.
/// Whatever goes wrong ends the connection: a new one is a new object. One thread.
class ServiceSocket {
 public:
  ServiceSocket();
  ~ServiceSocket();
  ServiceSocket(const ServiceSocket&) = delete;
  ServiceSocket& operator=(const ServiceSocket&) = delete;

  /// To 127.0.0.1. Error: kNoDevice, nobody answers there.
  Result<void> connect(std::uint16_t port, std::chrono::milliseconds limit);
  /// Whether the message went out in time.
  bool send(const std::string& text, std::chrono::milliseconds limit);
  /// The next message; nothing when none came in time or the connection has ended.
  std::optional<std::string> receive(std::chrono::milliseconds limit);

 private:
  struct Stream;  // keeps Beast out of whoever includes this
  std::unique_ptr<Stream> stream_;
};

}  // namespace palpate::inverse3

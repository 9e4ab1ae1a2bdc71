#include "driver/inverse3/service_socket.h"

#include <boost/asio/ip/tcp.hpp>
#include <boost/beast/core.hpp>
#include <boost/beast/websocket.hpp>

namespace palpate::inverse3 {

namespace asio = boost::asio;
namespace beast = boost::beast;
using asio::ip::tcp;
using std::chrono::milliseconds;

namespace {

/// A message of a service with a dozen devices has some 10 kB.
constexpr std::size_t kLongestMessage = 1 << 20;

}  // namespace

struct ServiceSocket::Stream {
  asio::io_context io;
  beast::websocket::stream<tcp::socket> socket{io};

  /// Runs what has been started until its handler has set `ended`. What takes longer is broken off, and with
  /// it the connection.
  bool within(milliseconds limit, const std::optional<beast::error_code>& ended) {
    io.restart();
    io.run_for(limit);
    if (!ended) {
      beast::error_code ignored;
      beast::get_lowest_layer(socket).close(ignored);
      io.restart();
      io.run();  // the handler, which hears that it was broken off
    }
    return ended && !*ended;
  }
};

ServiceSocket::ServiceSocket() : stream_(std::make_unique<Stream>()) {}
ServiceSocket::~ServiceSocket() = default;

Result<void> ServiceSocket::connect(std::uint16_t port, milliseconds limit) {
  const Error nobody{ErrorCode::kNoDevice, "nothing answers at 127.0.0.1:" + std::to_string(port) +
                                               "; the device's own service has to run on this machine"};
  auto& socket = stream_->socket;
  std::optional<beast::error_code> ended;
  auto end = [&](beast::error_code error) { ended = error; };
  beast::get_lowest_layer(socket).async_connect({asio::ip::address_v4::loopback(), port}, end);
  if (!stream_->within(limit, ended)) return nobody;
  beast::error_code ignored;
  beast::get_lowest_layer(socket).set_option(tcp::no_delay(true), ignored);
  socket.read_message_max(kLongestMessage);
  ended.reset();
  socket.async_handshake("127.0.0.1:" + std::to_string(port), "/", end);
  if (!stream_->within(limit, ended)) return nobody;
  return {};
}

bool ServiceSocket::send(const std::string& text, milliseconds limit) {
  std::optional<beast::error_code> ended;
  stream_->socket.async_write(asio::buffer(text),
                              [&](beast::error_code error, std::size_t) { ended = error; });
  return stream_->within(limit, ended);
}

std::optional<std::string> ServiceSocket::receive(milliseconds limit) {
  std::optional<beast::error_code> ended;
  beast::flat_buffer buffer;
  stream_->socket.async_read(buffer, [&](beast::error_code error, std::size_t) { ended = error; });
  if (!stream_->within(limit, ended)) return std::nullopt;
  return beast::buffers_to_string(buffer.data());
}

}  // namespace palpate::inverse3

#include "tests/driver/inverse3_service.h"

#include <sys/socket.h>

#include <boost/asio/ip/tcp.hpp>
#include <boost/beast/core.hpp>
#include <boost/beast/websocket.hpp>

namespace palpate::fake {

namespace asio = boost::asio;
namespace beast = boost::beast;
using asio::ip::tcp;
using Json = nlohmann::json;

struct Inverse3Service::Server {
  asio::io_context io;
  tcp::acceptor acceptor;
  std::mutex mutex;  // over `client` and `stopping`
  int client = -1;
  bool stopping = false;

  explicit Server(std::uint16_t port) : acceptor(io, {asio::ip::address_v4::loopback(), port}) {}

  /// Ends whatever the thread waits for.
  void stop() {
    const std::lock_guard lock(mutex);
    stopping = true;
    ::shutdown(acceptor.native_handle(), SHUT_RDWR);
    if (client >= 0) ::shutdown(client, SHUT_RDWR);
  }
  bool begin(int descriptor) {
    const std::lock_guard lock(mutex);
    client = descriptor;
    return !stopping;
  }
  void end() {
    const std::lock_guard lock(mutex);
    client = -1;
  }
};

Inverse3Service::Inverse3Service() { start(); }
Inverse3Service::~Inverse3Service() { stop(); }

void Inverse3Service::start() {
  server_ = std::make_unique<Server>(port_);
  port_ = server_->acceptor.local_endpoint().port();
  thread_ = std::thread([this] { serve(); });
}

void Inverse3Service::stop() {
  if (!server_) return;
  server_->stop();
  thread_.join();
  server_.reset();
}

Json Inverse3Service::devices(bool inventory) const {
  Json message = Json::object();
  if (model.session_ids) message["session_id"] = 7;
  message["inverse3"] = Json::array();
  message["verse_grip"] = Json::array();
  message["wireless_verse_grip"] = Json::array();
  const auto vector = [](const Vec3& v) { return Json{{"x", v.x}, {"y", v.y}, {"z", v.z}}; };
  if (model.plugged) {
    Json arm{{"device_id", "049D"},
             {"state", {{"cursor_position", vector(model.cursor)}, {"cursor_velocity", vector(Vec3(0))}}},
             {"status", {{"ready", model.ready}, {"power_supply", true}, {"calibrated", true}}}};
    if (inventory) arm["config"] = {{"type", "inverse3"}, {"handedness", "right"}};
    message["inverse3"].push_back(std::move(arm));
  }
  if (model.has_grip) {
    Json grip{{"device_id", "61548"},
              {"state", {{"buttons", {{"a", model.a}, {"b", model.b}, {"c", false}}}, {"hall", 0}}}};
    if (model.grip_speaks)
      grip["state"]["orientation"] = {
          {"w", model.grip.w}, {"x", model.grip.x}, {"y", model.grip.y}, {"z", model.grip.z}};
    message["wireless_verse_grip"].push_back(std::move(grip));
  }
  return message;
}

void Inverse3Service::answer(const std::string& text) {
  const Json message = Json::parse(text, nullptr, false);
  const char* spelling = model.session_ids ? "vector" : "values";
  const Json::json_pointer force("/inverse3/0/commands/set_cursor_force/" + std::string(spelling));
  if (message.is_discarded() || !message.contains(force) || message["inverse3"][0]["device_id"] != "049D") {
    ++model.strange;
    return;
  }
  const Json& f = message[force];
  model.force = Vec3(f.at("x"), f.at("y"), f.at("z"));
  ++model.forces;
}

void Inverse3Service::serve() {
  for (;;) {
    beast::error_code error;
    tcp::socket accepted = server_->acceptor.accept(error);
    if (error || !server_->begin(accepted.native_handle())) return;
    accepted.set_option(tcp::no_delay(true), error);
    beast::websocket::stream<tcp::socket> socket(std::move(accepted));
    while (!error && locked([](auto& m) { return m.wordless; })) {
      beast::flat_buffer heard;
      const auto room = heard.prepare(512);
      heard.commit(socket.next_layer().read_some(room, error));  // and no word back
    }
    if (!error) socket.accept(error);
    if (!error) socket.write(asio::buffer(locked([&](auto&) { return devices(true).dump(); })), error);
    while (!error) {
      beast::flat_buffer buffer;
      socket.read(buffer, error);
      if (error) break;
      const std::string reply = locked([&](auto& m) {
        answer(beast::buffers_to_string(buffer.data()));
        if (m.silent) return std::string();
        return m.garbage.empty() ? devices(false).dump() : m.garbage;
      });
      if (!reply.empty()) socket.write(asio::buffer(reply), error);
    }
    server_->end();
  }
}

}  // namespace palpate::fake

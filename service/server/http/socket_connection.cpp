#include <utility>

#include <boost/asio/buffer.hpp>
#include <boost/asio/co_spawn.hpp>
#include <boost/asio/detached.hpp>
#include <boost/asio/post.hpp>
#include <boost/asio/redirect_error.hpp>
#include <boost/asio/steady_timer.hpp>
#include <boost/asio/use_awaitable.hpp>
#include <boost/beast/websocket.hpp>

#include "service/server/http/connection.h"

namespace palpate {
namespace {

namespace asio = boost::asio;
namespace beast = boost::beast;
namespace http = beast::http;
namespace websocket = beast::websocket;
using boost::system::error_code;

constexpr auto kSilence =
    std::chrono::seconds(30);  ///< without a byte from the client, pongs included; chosen
constexpr auto kHandshake = std::chrono::seconds(10);

/// A WebSocket's two directions, each a coroutine on the connection's strand; both hold this.
class Conversation : public std::enable_shared_from_this<Conversation> {
 public:
  Conversation(AnyStream stream, std::shared_ptr<SocketHandler> handler, ConnectionContext& context)
      : socket_(std::move(stream)),
        wake_(socket_.get_executor()),
        handler_(std::move(handler)),
        context_(context) {}

  asio::awaitable<void> run(http::request<http::empty_body> head) {
    websocket::stream_base::timeout timeout{};
    timeout.handshake_timeout = kHandshake;
    timeout.idle_timeout = kSilence;
    timeout.keep_alive_pings = true;
    socket_.set_option(timeout);
    socket_.read_message_max(context_.limits.message_bytes);
    const bool named = http::token_list(head[http::field::sec_websocket_protocol]).exists("palpate");
    socket_.set_option(websocket::stream_base::decorator([named](websocket::response_type& response) {
      response.set(http::field::server, "palpate");
      if (named) response.set(http::field::sec_websocket_protocol, "palpate");
    }));
    error_code error;
    co_await socket_.async_accept(head, asio::redirect_error(asio::use_awaitable, error));
    if (error) {
      handler_->closed();
      co_return;
    }
    const auto self = shared_from_this();
    const auto waker = [weak = weak_from_this(), executor = socket_.get_executor()] {
      asio::post(executor, [weak] {
        if (const auto conversation = weak.lock()) conversation->wake();
      });
    };
    std::list<std::function<void()>>::iterator closer;
    {
      const std::lock_guard lock(context_.mutex);
      closer = context_.closers.insert(context_.closers.end(), waker);
    }
    handler_->start(waker);
    asio::co_spawn(socket_.get_executor(), write(self), asio::detached);
    beast::flat_buffer buffer;
    for (;;) {
      buffer.clear();
      co_await socket_.async_read(buffer, asio::redirect_error(asio::use_awaitable, error));
      if (error) break;
      handler_->message({static_cast<const char*>(buffer.data().data()), buffer.size()},
                        socket_.got_binary());
    }
    {
      const std::lock_guard lock(context_.mutex);
      context_.closers.erase(closer);
    }
    over_ = true;
    handler_->closed();
    wake();
  }

 private:
  void wake() {
    woken_ = true;
    wake_.cancel();
  }

  /// `self` keeps this alive until the coroutine has ended.
  static asio::awaitable<void> write(std::shared_ptr<Conversation> self) { co_await self->write_all(); }

  asio::awaitable<void> write_all() {
    error_code error;
    while (!over_ && !error) {
      woken_ = false;
      std::optional<SocketMessage> message;
      if (!context_.stopping)
        message = handler_->next();
      else if (!std::exchange(parting_, true))
        message = handler_->last_words();
      if (!message && parting_)
        message = SocketMessage{R"({"type":"bye","reason":"the server stops"})", nullptr, false, true};
      if (message) {
        socket_.binary(message->binary);
        const std::array<asio::const_buffer, 2> parts = {
            asio::buffer(message->head), message->tail ? asio::buffer(*message->tail) : asio::const_buffer()};
        co_await socket_.async_write(parts, asio::redirect_error(asio::use_awaitable, error));
        if (message->close && !error) {
          co_await socket_.async_close(context_.stopping ? websocket::close_code::going_away
                                                         : static_cast<websocket::close_code>(message->code),
                                       asio::redirect_error(asio::use_awaitable, error));
          break;
        }
      } else if (!woken_) {
        wake_.expires_at(std::chrono::steady_clock::time_point::max());
        error_code cancelled;
        co_await wake_.async_wait(asio::redirect_error(asio::use_awaitable, cancelled));
      }
    }
  }

  websocket::stream<AnyStream, false> socket_;  // without compression: it would cost more than it saves here
  asio::steady_timer wake_;
  std::shared_ptr<SocketHandler> handler_;
  ConnectionContext& context_;
  bool woken_ = false, over_ = false, parting_ = false;
};

}  // namespace

asio::awaitable<void> serve_socket(AnyStream stream, http::request<http::empty_body> head,
                                   std::shared_ptr<SocketHandler> handler, ConnectionContext& context) {
  const auto conversation = std::make_shared<Conversation>(std::move(stream), std::move(handler), context);
  co_await conversation->run(std::move(head));
}

}  // namespace palpate

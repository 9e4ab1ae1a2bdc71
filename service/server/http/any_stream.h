#pragma once
// Heavy: for the few .cpp files that talk to sockets.
#include <utility>  // boost/asio/awaitable.hpp of 1.74 forgets it

#include <boost/asio/any_io_executor.hpp>
#include <boost/asio/ssl/context.hpp>
#include <boost/beast/core/tcp_stream.hpp>
#include <boost/beast/ssl/ssl_stream.hpp>
#include <boost/beast/websocket/teardown.hpp>
#include <variant>

namespace palpate {

/// A TCP connection, with TLS or without: one type, so that what reads HTTP and WebSockets is compiled once.
class AnyStream {
 public:
  using Plain = boost::beast::tcp_stream;
  using Secure = boost::beast::ssl_stream<Plain>;
  using executor_type = Plain::executor_type;

  AnyStream(Plain stream, boost::asio::ssl::context* tls) {
    if (tls)
      secure_ = std::make_unique<Secure>(std::move(stream), *tls);
    else
      plain_ = std::make_unique<Plain>(std::move(stream));
  }
  AnyStream(AnyStream&&) = default;
  AnyStream& operator=(AnyStream&&) = default;

  executor_type get_executor() noexcept { return lowest().get_executor(); }
  Plain& lowest() noexcept { return secure_ ? secure_->next_layer() : *plain_; }
  Secure* secure() noexcept { return secure_.get(); }

  template <class Buffers, class Handler>
  auto async_read_some(const Buffers& buffers, Handler&& handler) {
    return boost::asio::async_initiate<Handler, void(boost::system::error_code, std::size_t)>(
        [this](auto&& done, const Buffers& into) {
          if (secure_)
            secure_->async_read_some(into, std::forward<decltype(done)>(done));
          else
            plain_->async_read_some(into, std::forward<decltype(done)>(done));
        },
        handler, buffers);
  }
  template <class Buffers, class Handler>
  auto async_write_some(const Buffers& buffers, Handler&& handler) {
    return boost::asio::async_initiate<Handler, void(boost::system::error_code, std::size_t)>(
        [this](auto&& done, const Buffers& from) {
          if (secure_)
            secure_->async_write_some(from, std::forward<decltype(done)>(done));
          else
            plain_->async_write_some(from, std::forward<decltype(done)>(done));
        },
        handler, buffers);
  }

 private:
  std::unique_ptr<Plain> plain_;
  std::unique_ptr<Secure> secure_;
};

// What boost::beast::websocket asks of a stream that is not its own; found by argument-dependent lookup.
inline void beast_close_socket(AnyStream& stream) {
  boost::system::error_code ignored;
  stream.lowest().socket().close(ignored);
}

inline void teardown(boost::beast::role_type role, AnyStream& stream, boost::system::error_code& error) {
  boost::beast::websocket::teardown(role, stream.lowest().socket(), error);
}

template <class Handler>
void async_teardown(boost::beast::role_type role, AnyStream& stream, Handler&& handler) {
  // Without TLS's own farewell: the close frames of the WebSocket have been exchanged.
  boost::beast::websocket::async_teardown(role, stream.lowest().socket(), std::forward<Handler>(handler));
}

}  // namespace palpate

#pragma once
// Heavy: for the few .cpp files that talk to sockets.
#include <atomic>
#include <boost/asio/awaitable.hpp>
#include <boost/beast/core/flat_buffer.hpp>
#include <boost/beast/http/empty_body.hpp>
#include <boost/beast/http/message.hpp>
#include <functional>
#include <list>
#include <memory>
#include <mutex>
#include <string>

#include "service/server/http/any_stream.h"
#include "service/server/http/auth.h"
#include "service/server/http/limits.h"
#include "service/server/http/router.h"
#include "service/server/log.h"
#include "service/server/metrics.h"

namespace palpate {

/// What all connections of a listener share.
struct ConnectionContext {
  const Router& router;
  const AccessRules& rules;
  const ServerLimits& limits;
  Metrics& metrics;
  Log& log;
  std::atomic<bool> stopping{false};
  std::atomic<int> busy{0};  ///< requests being answered and WebSockets
  std::mutex mutex;
  std::list<std::function<void()>> closers;  ///< of open connections: each posts to its own strand
};

/// Answers one connection until it ends. On its own strand; never throws.
boost::asio::awaitable<void> serve_connection(AnyStream stream, std::string peer, ConnectionContext& context);

/// Holds a WebSocket's conversation until it ends.
boost::asio::awaitable<void> serve_socket(AnyStream stream,
                                          boost::beast::http::request<boost::beast::http::empty_body> head,
                                          std::shared_ptr<SocketHandler> handler, ConnectionContext& context);

}  // namespace palpate

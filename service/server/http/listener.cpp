#include "service/server/http/listener.h"

#include <sys/resource.h>

#include <algorithm>
#include <boost/asio/co_spawn.hpp>
#include <boost/asio/detached.hpp>
#include <boost/asio/io_context.hpp>
#include <boost/asio/ip/tcp.hpp>
#include <boost/asio/post.hpp>
#include <boost/asio/redirect_error.hpp>
#include <boost/asio/ssl/context.hpp>
#include <boost/asio/steady_timer.hpp>
#include <boost/asio/strand.hpp>
#include <boost/asio/use_awaitable.hpp>
#include <chrono>
#include <nlohmann/json.hpp>
#include <thread>
#include <vector>

#include "service/loop/thread_share.h"
#include "service/server/http/connection.h"

namespace palpate {
namespace {

namespace asio = boost::asio;
using asio::ip::tcp;
using boost::system::error_code;

constexpr int kThreads = 2;  ///< chosen: they decode and copy; what takes long is done elsewhere

/// As many open files as the system lets us have: a connection is one.
void raise_open_files() {
  rlimit limit{};
  if (::getrlimit(RLIMIT_NOFILE, &limit) != 0) return;
  limit.rlim_cur = std::min<rlim_t>(limit.rlim_max, 65536);
  ::setrlimit(RLIMIT_NOFILE, &limit);
}

constexpr std::string_view kBusy =
    "HTTP/1.1 503 Service Unavailable\r\nContent-Type: application/problem+json\r\nRetry-After: "
    "1\r\nConnection: close\r\nContent-Length: 116\r\n\r\n"
    R"({"type":"urn:palpate:problem:busy","title":"Busy","status":503,"detail":"there are too many connections; ask again"})";

}  // namespace

bool is_loopback(const std::string& address) {
  error_code error;
  const auto parsed = asio::ip::make_address(address, error);
  return !error && parsed.is_loopback();
}

struct Listener::State {
  State(const Router& router, const AccessRules& rules, const ServerLimits& limits, Metrics& metrics,
        Log& log)
      : context{router, rules, limits, metrics, log, {}, {}, {}, {}} {}

  asio::io_context io{kThreads};
  ConnectionContext context;
  std::optional<asio::ssl::context> tls;
  std::optional<tcp::acceptor> acceptor;
  std::vector<std::thread> threads;
  std::uint16_t port = 0;

  asio::awaitable<void> accept_loop() {
    for (;;) {
      error_code error;
      tcp::socket socket(asio::make_strand(io));
      co_await acceptor->async_accept(socket, asio::redirect_error(asio::use_awaitable, error));
      if (context.stopping || !acceptor->is_open()) co_return;
      if (error) {  // out of descriptors, mostly: what is open goes on, new ones wait
        asio::steady_timer pause(io, std::chrono::milliseconds(100));
        co_await pause.async_wait(asio::redirect_error(asio::use_awaitable, error));
        continue;
      }
      ++context.metrics.connections;
      if (context.metrics.connections_now >= context.limits.connections) {
        ++context.metrics.connections_refused;
        socket.non_blocking(true, error);
        socket.write_some(asio::buffer(kBusy), error);
        socket.shutdown(tcp::socket::shutdown_both, error);
        continue;
      }
      socket.set_option(tcp::no_delay(true), error);
      const auto endpoint = socket.remote_endpoint(error);
      std::string peer = error ? std::string("?") : endpoint.address().to_string();
      ++context.metrics.connections_now;
      const auto executor = socket.get_executor();
      AnyStream stream(AnyStream::Plain(std::move(socket)), tls ? &*tls : nullptr);
      asio::co_spawn(executor, serve_connection(std::move(stream), std::move(peer), context),
                     [this](std::exception_ptr) { --context.metrics.connections_now; });
    }
  }
};

Listener::Listener(const Router& router, const AccessRules& rules, const ServerLimits& limits,
                   Metrics& metrics, Log& log)
    : state_(std::make_unique<State>(router, rules, limits, metrics, log)) {}

Listener::~Listener() { stop(0); }

Result<void> Listener::start(const ListenOptions& options) {
  raise_open_files();
  try {
    if (!options.certificate.empty()) {
      state_->tls.emplace(asio::ssl::context::tls_server);
      state_->tls->set_options(asio::ssl::context::default_workarounds | asio::ssl::context::no_tlsv1 |
                               asio::ssl::context::no_tlsv1_1);
      state_->tls->use_certificate_chain_file(options.certificate);
      state_->tls->use_private_key_file(options.key, asio::ssl::context::pem);
    }
  } catch (const std::exception& error) {
    return bad_value("the certificate '" + options.certificate + "' with the key '" + options.key +
                     "' can't be used: " + error.what());
  }
  try {
    const tcp::endpoint endpoint(asio::ip::make_address(options.address), options.port);
    state_->acceptor.emplace(state_->io);
    state_->acceptor->open(endpoint.protocol());
    state_->acceptor->set_option(tcp::acceptor::reuse_address(true));
    state_->acceptor->bind(endpoint);
    state_->acceptor->listen(1024);
    state_->port = state_->acceptor->local_endpoint().port();
  } catch (const std::exception& error) {
    return bad_value("--listen " + options.address + ":" + std::to_string(options.port) +
                     " can't be had: " + error.what());
  }
  asio::co_spawn(state_->io, state_->accept_loop(), asio::detached);
  for (int i = 0; i < kThreads; ++i)
    state_->threads.emplace_back([this] {
      set_nice(kNiceConnections);
      state_->io.run();
    });
  return {};
}

std::uint16_t Listener::port() const { return state_->port; }

void Listener::stop(double grace_s) {
  if (state_->threads.empty()) return;
  state_->context.stopping = true;
  asio::post(state_->io, [this] {
    error_code ignored;
    state_->acceptor->close(ignored);
  });
  {
    const std::lock_guard lock(state_->context.mutex);
    for (const auto& closer : state_->context.closers) closer();
  }
  // What is being answered and every farewell gets its time; who merely rests on a kept connection does not.
  const auto end = std::chrono::steady_clock::now() + std::chrono::duration<double>(grace_s);
  while (state_->context.busy > 0 && std::chrono::steady_clock::now() < end)
    std::this_thread::sleep_for(std::chrono::milliseconds(5));
  state_->io.stop();
  for (std::thread& thread : state_->threads) thread.join();
  state_->threads.clear();
}

}  // namespace palpate

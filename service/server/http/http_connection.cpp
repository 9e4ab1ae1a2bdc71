#include <netinet/tcp.h>
#include <sys/socket.h>

#include <utility>

#include <atomic>
#include <boost/asio/buffer.hpp>
#include <boost/asio/co_spawn.hpp>
#include <boost/asio/post.hpp>
#include <boost/asio/redirect_error.hpp>
#include <boost/asio/steady_timer.hpp>
#include <boost/asio/use_awaitable.hpp>
#include <boost/asio/write.hpp>
#include <boost/beast/http.hpp>
#include <boost/beast/websocket/rfc6455.hpp>
#include <chrono>
#include <limits>
#include <memory>
#include <nlohmann/json.hpp>

#include "service/server/http/connection.h"
#include "service/server/http/json_input.h"

namespace palpate {
namespace {

namespace asio = boost::asio;
namespace beast = boost::beast;
namespace http = beast::http;
using boost::system::error_code;
using Clock = std::chrono::steady_clock;
using Parser = http::request_parser<http::buffer_body>;

constexpr std::size_t kPiece = 64 << 10;
constexpr std::size_t kLongestTarget = 2048;  // characters (chosen)
constexpr auto kLingering =
    std::chrono::seconds(3);  ///< chosen: hundreds of MB from next door, many from afar

std::chrono::nanoseconds seconds(double s) {
  return std::chrono::nanoseconds(static_cast<std::int64_t>(s * 1e9));
}

std::string_view view(boost::beast::string_view text) { return {text.data(), text.size()}; }

/// Ends what is being read when its time is over. The stream's own deadline would close the connection, and
/// the client could not be told why.
class ReadDeadline {
 public:
  /// `stream` outlives this; it has no other deadline meanwhile.
  ReadDeadline(AnyStream& stream, std::chrono::nanoseconds time)
      : timer_(stream.lowest().get_executor(), time) {
    stream.lowest().expires_never();
    timer_.async_wait([state = state_, &lowest = stream.lowest()](error_code error) {
      if (error || !state->reading) return;
      state->late = true;
      lowest.cancel();
    });
  }
  ~ReadDeadline() { state_->reading = false; }  // the handler may be on its way already
  ReadDeadline(const ReadDeadline&) = delete;
  ReadDeadline& operator=(const ReadDeadline&) = delete;
  bool late() const { return state_->late; }

 private:
  struct State {
    bool reading = true, late = false;
  };
  std::shared_ptr<State> state_ = std::make_shared<State>();
  asio::steady_timer timer_;
};

/// Tells who works for a client that it has gone: asks the kernel now and then whether the client has closed
/// its end. (Reading would tell, too, but what is read may be the next request, or a part of TLS.)
class ClientWatch {
 public:
  explicit ClientWatch(AnyStream& stream) : state_(std::make_shared<State>(stream)) { look(state_); }
  ~ClientWatch() {
    state_->stream = nullptr;  // the handler may be on its way already
    state_->timer.cancel();
  }
  ClientWatch(const ClientWatch&) = delete;
  ClientWatch& operator=(const ClientWatch&) = delete;
  /// True from then on; any thread may look.
  std::shared_ptr<const std::atomic<bool>> gone() const { return {state_, &state_->gone}; }

 private:
  struct State {
    explicit State(AnyStream& of) : stream(&of), timer(of.lowest().get_executor()) {}
    AnyStream* stream;
    asio::steady_timer timer;
    std::atomic<bool> gone{false};
  };
  static void look(const std::shared_ptr<State>& state) {
    state->timer.expires_after(seconds(0.25));  // chosen: soon for people, nothing for the processor
    state->timer.async_wait([state](error_code error) {
      if (error || state->stream == nullptr) return;
      tcp_info info{};
      socklen_t size = sizeof info;
      const int socket = state->stream->lowest().socket().native_handle();
      if (getsockopt(socket, IPPROTO_TCP, TCP_INFO, &info, &size) == 0 && info.tcpi_state != TCP_ESTABLISHED)
        state->gone = true;
      else
        look(state);
    });
  }
  std::shared_ptr<State> state_;
};

/// One connection's conversation.
class HttpConnection {
 public:
  HttpConnection(AnyStream stream, std::string peer, ConnectionContext& context)
      : stream_(std::move(stream)),
        peer_(std::move(peer)),
        context_(context),
        buffer_(context.limits.header_bytes + kPiece) {}

  asio::awaitable<void> run() {
    if (stream_.secure()) {
      error_code error;
      stream_.lowest().expires_after(seconds(context_.limits.header_s));
      co_await stream_.secure()->async_handshake(asio::ssl::stream_base::server,
                                                 asio::redirect_error(asio::use_awaitable, error));
      if (error) co_return;
    }
    for (bool first = true; !context_.stopping; first = false)
      if (!co_await one_request(first)) break;
    error_code ignored;
    if (!upgraded_) stream_.lowest().socket().shutdown(asio::ip::tcp::socket::shutdown_send, ignored);
  }

 private:
  /// Reads a request and answers it. False: the connection is over.
  asio::awaitable<bool> one_request(bool first) {
    Parser parser;
    parser.header_limit(static_cast<std::uint32_t>(context_.limits.header_bytes));
    parser.body_limit(std::numeric_limits<std::uint64_t>::max());  // by route, below
    error_code error;
    // A new connection has the head's time from the start; a kept one may rest longer.
    if (!first && buffer_.size() == 0) {
      stream_.lowest().expires_after(seconds(context_.limits.idle_s));
      std::size_t got = 0;
      got = co_await stream_.async_read_some(buffer_.prepare(kPiece),
                                             asio::redirect_error(asio::use_awaitable, error));
      if (error) co_return false;
      buffer_.commit(got);
    }
    // The head is gathered here, so that one that drips in, or stops, can still be told so.
    started_ = Clock::now();
    method_ = path_ = "-";
    head_only_ = false;
    version_ = 11;
    route_ = "none";
    const Clock::time_point end =
        started_ + std::chrono::duration_cast<Clock::duration>(seconds(context_.limits.header_s));
    while (!head_complete() && buffer_.size() <= context_.limits.header_bytes) {
      const ReadDeadline deadline(stream_, end - Clock::now());
      const std::size_t got = co_await stream_.async_read_some(
          buffer_.prepare(4096), asio::redirect_error(asio::use_awaitable, error));
      if (deadline.late() ? buffer_.size() == 0 : error.failed())
        co_return false;  // who never began to ask needs no answer
      buffer_.commit(got);
      if (deadline.late() || Clock::now() > end) {
        refusal_ = Problem{408, "slow", "the head of the request did not come in time", ""};
        co_return co_await refuse();
      }
    }
    co_await http::async_read_header(stream_, buffer_, parser,
                                     asio::redirect_error(asio::use_awaitable, error));
    struct Busy {
      explicit Busy(std::atomic<int>& count) : count_(count) { ++count_; }
      ~Busy() { --count_; }
      std::atomic<int>& count_;
    } const busy(context_.busy);
    HttpRequest request;
    if (error) {
      if (error == http::error::header_limit || error == http::error::buffer_overflow) {
        refusal_ =
            Problem{431, "header",
                    "the head is larger than " + std::to_string(context_.limits.header_bytes) + " bytes", ""};
        co_return co_await refuse();
      }
      if (error.category() == http::make_error_code(http::error::bad_method).category() &&
          error != http::error::end_of_stream && error != http::error::partial_message) {
        refusal_ = Problem{400, "bad-request", "this is no HTTP/1.1 request: " + error.message(), ""};
        co_return co_await refuse();
      }
      co_return false;
    }
    auto& head = parser.get();
    method_ = std::string(view(head.method_string()).substr(0, 20));
    request.method = method_;
    path_ = std::string(view(head.target()).substr(0, 200));
    path_ = path_.substr(0, path_.find('?'));
    head_only_ = head.method() == http::verb::head;
    version_ = head.version();
    keep_alive_ = head.keep_alive();
    if (head.version() != 11 && head.version() != 10) {
      refusal_ = Problem{400, "bad-request", "only HTTP/1.1 and 1.0 are spoken here", ""};
      co_return co_await refuse();
    }
    if (head.target().size() > kLongestTarget) {
      refusal_ = Problem{431, "header",
                         "the target has " + std::to_string(head.target().size()) +
                             " characters; it may have " + std::to_string(kLongestTarget),
                         "target"};
      co_return co_await refuse();
    }
    if (!decode_target(view(head.target()), request)) {
      refusal_ = Problem{400, "bad-request", "the target is no path that is taken here", "target"};
      co_return co_await refuse();
    }
    if (head.count(http::field::host) > 1) {
      refusal_ = Problem{400, "bad-request", "there are several Host fields", "Host"};
      co_return co_await refuse();
    }

    // Who asks, and for what, before any byte of the body.
    std::string allowed;
    const auto found = context_.router.find(request, allowed);
    const Route* route =
        std::holds_alternative<const Route*>(found) ? std::get<const Route*>(found) : nullptr;
    const AccessFields fields{view(head[http::field::host]), view(head[http::field::origin]),
                              view(head[http::field::authorization]),
                              view(head[http::field::sec_websocket_protocol])};
    if (auto problem = refuse_access(context_.rules, fields, route && route->open)) {
      refusal_ = *problem;
      co_return co_await refuse();
    }
    if (!route) {
      HttpResponse response(std::get<Problem>(found));
      if (!allowed.empty()) response.headers.emplace_back("Allow", allowed);
      keep_alive_ = keep_alive_ && parser.is_done();
      co_return co_await send(response) && keep_alive_;
    }
    route_ = route->pattern;
    if (auto problem = refuse_parameters(*route, request)) {
      refusal_ = *problem;
      co_return co_await refuse();
    }
    request.content_type = std::string(view(head[http::field::content_type]));
    request.accept = std::string(view(head[http::field::accept]));
    request.range = std::string(view(head[http::field::range]));

    if (route->socket) {
      if (!beast::websocket::is_upgrade(head)) {
        refusal_ = Problem{426, "upgrade", "this is a WebSocket", ""};
        co_return co_await refuse();
      }
      auto opened = route->socket(request);
      if (const auto* problem = std::get_if<Problem>(&opened)) {
        refusal_ = *problem;
        co_return co_await refuse();
      }
      upgraded_ = true;
      account(101);
      http::request<http::empty_body> upgrade;
      upgrade.base() = head.base();
      stream_.lowest().expires_never();
      asio::awaitable<void> conversation = serve_socket(
          std::move(stream_), std::move(upgrade), std::get<std::shared_ptr<SocketHandler>>(opened), context_);
      co_await std::move(conversation);
      co_return false;
    }

    if (const auto coding = view(head[http::field::content_encoding]);
        !coding.empty() && !beast::iequals(head[http::field::content_encoding], "identity")) {
      refusal_ = Problem{415, "media-type", "a body is taken as it is, without Content-Encoding",
                         "Content-Encoding"};
      co_return co_await refuse();
    }
    if (const auto coding = view(head[http::field::transfer_encoding]);
        !coding.empty() && !beast::iequals(head[http::field::transfer_encoding], "chunked")) {
      refusal_ =
          Problem{501, "not-implemented", "the only Transfer-Encoding here is chunked", "Transfer-Encoding"};
      co_return co_await refuse();
    }
    const bool sink_fits = route->sink && media_type(request.content_type) == route->sink_type;
    const std::size_t limit = sink_fits ? route->sink_limit : route->body_limit;
    const bool has_body = !parser.is_done() && (parser.chunked() || parser.content_length().value_or(0) > 0);
    const Problem large{413, "too-large", "the body may have " + std::to_string(limit) + " bytes here",
                        "body"};
    if (parser.content_length().value_or(0) > limit) {
      refusal_ = large;
      co_return co_await refuse();
    }
    if (has_body && view(head[http::field::expect]) == "100-continue") {
      http::response<http::empty_body> go_on(http::status::continue_, head.version());
      co_await http::async_write(stream_, go_on, asio::redirect_error(asio::use_awaitable, error));
      if (error) co_return false;
    }
    std::unique_ptr<BodySink> sink;
    if (sink_fits) sink = route->sink(request);
    const std::optional<Problem> problem = co_await read_body(parser, limit, large, sink.get(), request.body);
    if (problem) {
      sink.reset();  // what it wrote is gone before the client can try again
      if (problem->status == 0) co_return false;
      refusal_ = *problem;
      co_return co_await refuse();
    }
    HttpResponse response = co_await answer(*route, request, sink.get());
    sink.reset();
    co_return co_await send(response) && keep_alive_;
  }

  bool head_complete() const {
    const auto data = buffer_.data();
    return std::string_view(static_cast<const char*>(data.data()), data.size()).find("\r\n\r\n") !=
           std::string_view::npos;
  }

  /// The whole body into `text`, or into the sink. Status 0: the client has gone.
  asio::awaitable<std::optional<Problem>> read_body(Parser& parser, std::size_t limit, const Problem& large,
                                                    BodySink* sink, std::string& text) {
    std::vector<char> piece(parser.is_done() ? 0 : kPiece);
    std::size_t total = 0;
    while (!parser.is_done()) {
      parser.get().body().data = piece.data();
      parser.get().body().size = piece.size();
      // Both a client that stops and one that drips are cut off.
      const double allowed =
          context_.limits.piece_s + static_cast<double>(total) / context_.limits.slowest_bytes_per_s;
      if (Clock::now() - started_ > seconds(allowed))
        co_return Problem{408, "slow", "the body comes too slowly", "body"};
      const ReadDeadline deadline(stream_, seconds(context_.limits.piece_s));
      error_code error;
      co_await http::async_read_some(stream_, buffer_, parser,
                                     asio::redirect_error(asio::use_awaitable, error));
      if (error == http::error::need_buffer) error = {};
      if (deadline.late()) co_return Problem{408, "slow", "the body did not come in time", "body"};
      if (error == http::error::end_of_stream || error == http::error::partial_message ||
          (error && error.category() == boost::system::system_category()))
        co_return Problem{0, "", "", ""};
      if (error) co_return Problem{400, "bad-request", "the body is no HTTP: " + error.message(), "body"};
      const std::size_t got = piece.size() - parser.get().body().size;
      total += got;
      if (total > limit) co_return large;
      if (sink) {
        if (auto problem = sink->write({piece.data(), got})) co_return problem;
      } else {
        text.append(piece.data(), got);
      }
    }
    co_return std::nullopt;
  }

  asio::awaitable<HttpResponse> answer(const Route& route, HttpRequest& request, BodySink* sink) {
    stream_.lowest().expires_never();
    const ClientWatch watch(stream_);
    request.client_gone = watch.gone();
    co_return co_await asio::async_initiate<const asio::use_awaitable_t<>&, void(HttpResponse)>(
        [&](auto&& done) {
          // A reply may be copied and may come on any thread; the conversation goes on on its own strand.
          auto handler = std::make_shared<std::decay_t<decltype(done)>>(std::forward<decltype(done)>(done));
          const Reply reply = [handler, executor = stream_.get_executor()](HttpResponse response) {
            asio::post(executor, [handler, response = std::move(response)]() mutable {
              (*handler)(std::move(response));
            });
          };
          try {
            if (sink)
              sink->finish(reply);
            else
              route.handle(std::move(request), reply);
          } catch (const std::exception& error) {
            reply(Problem{500, "internal", std::string("the request failed: ") + error.what(), ""});
          }
        },
        asio::use_awaitable);
  }

  asio::awaitable<Chunk> next_chunk(BodySource& source) {
    co_return co_await asio::async_initiate<const asio::use_awaitable_t<>&, void(Chunk)>(
        [&](auto&& done) {
          auto handler = std::make_shared<std::decay_t<decltype(done)>>(std::forward<decltype(done)>(done));
          source.next([handler, executor = stream_.get_executor()](Chunk chunk) {
            asio::post(executor,
                       [handler, chunk = std::move(chunk)]() mutable { (*handler)(std::move(chunk)); });
          });
        },
        asio::use_awaitable);
  }

  /// Answers and ends the connection: what else the client sends is not worth reading.
  asio::awaitable<bool> refuse() {
    keep_alive_ = false;
    HttpResponse response(refusal_);
    co_await send(response);
    // The client may still be sending; if it is not listened to for a moment, a reset may take the answer
    // from it.
    error_code error;
    error_code ignored;
    stream_.lowest().socket().shutdown(asio::ip::tcp::socket::shutdown_send, ignored);
    std::vector<char> waste(kPiece);
    const Clock::time_point end = Clock::now() + kLingering;
    while (!error && !context_.stopping && Clock::now() < end) {
      stream_.lowest().expires_after(seconds(0.5));
      co_await stream_.lowest().async_read_some(asio::buffer(waste),
                                                asio::redirect_error(asio::use_awaitable, error));
    }
    co_return false;
  }

  asio::awaitable<bool> send(HttpResponse& response) {
    account(response.status);
    http::response<http::buffer_body> message(static_cast<http::status>(response.status), 11);
    message.set(http::field::server, "palpate");
    if (response.status != 204) message.set(http::field::content_type, response.type);
    message.set("X-Content-Type-Options", "nosniff");
    message.set(http::field::cache_control, "no-store");
    for (const auto& [name, value] : response.headers) message.set(name, value);
    // Who speaks HTTP/1.0 knows no chunks: what has no length known beforehand ends with the connection.
    const bool streamed = response.source && !response.source_length, chunked = streamed && version_ == 11;
    keep_alive_ = keep_alive_ && chunked == streamed;
    message.keep_alive(keep_alive_ && !context_.stopping);
    if (chunked)
      message.chunked(true);
    else if (!streamed && response.status != 204)
      message.content_length(response.source ? *response.source_length : response.body.size());
    message.body().data = nullptr;
    message.body().more = true;
    http::response_serializer<http::buffer_body> serializer(message);
    error_code error;
    stream_.lowest().expires_after(seconds(context_.limits.piece_s));
    co_await http::async_write_header(stream_, serializer, asio::redirect_error(asio::use_awaitable, error));
    if (error) co_return false;
    if (head_only_ || response.status == 204) co_return true;
    if (!response.source) co_return co_await write_all(asio::buffer(response.body));
    for (;;) {
      stream_.lowest().expires_never();
      Chunk chunk = co_await next_chunk(*response.source);
      if (!chunk.data.empty()) {
        if (chunked) {
          if (!co_await write_chunk(chunk.data)) co_return false;
        } else if (!co_await write_all(asio::buffer(chunk.data))) {
          co_return false;
        }
      }
      if (chunk.broken) co_return false;
      if (chunk.last) break;
    }
    if (!chunked) co_return true;
    co_return co_await write_all(asio::buffer("0\r\n\r\n", 5));
  }

  asio::awaitable<bool> write_chunk(const std::string& data) {
    char size[20];
    const int length = std::snprintf(size, sizeof size, "%zx\r\n", data.size());
    const std::array<asio::const_buffer, 3> parts = {asio::buffer(size, static_cast<std::size_t>(length)),
                                                     asio::buffer(data), asio::buffer("\r\n", 2)};
    stream_.lowest().expires_after(seconds(
        context_.limits.piece_s + static_cast<double>(data.size()) / context_.limits.slowest_bytes_per_s));
    error_code error;
    co_await asio::async_write(stream_, parts, asio::redirect_error(asio::use_awaitable, error));
    co_return !error;
  }

  asio::awaitable<bool> write_all(asio::const_buffer data) {
    stream_.lowest().expires_after(seconds(
        context_.limits.piece_s + static_cast<double>(data.size()) / context_.limits.slowest_bytes_per_s));
    error_code error;
    co_await asio::async_write(stream_, data, asio::redirect_error(asio::use_awaitable, error));
    co_return !error;
  }

  void account(unsigned status) {
    context_.metrics.count_request(route_, status);
    context_.log.info("request",
                      {{"peer", peer_},
                       {"method", shown_text(method_)},
                       {"path", shown_text(path_)},
                       {"status", status},
                       {"ms", std::chrono::duration<double, std::milli>(Clock::now() - started_).count()}});
  }

  AnyStream stream_;
  std::string peer_;
  ConnectionContext& context_;
  beast::flat_buffer buffer_;
  Clock::time_point started_{};
  std::string method_, path_, route_;
  Problem refusal_;  ///< not a parameter of refuse(): GCC 12 destroys such a temporary of a co_await twice
  unsigned version_ = 11;  ///< of the request: 10 or 11
  bool keep_alive_ = true, upgraded_ = false, head_only_ = false;
};

}  // namespace

asio::awaitable<void> serve_connection(AnyStream stream, std::string peer, ConnectionContext& context) {
  auto connection = std::make_unique<HttpConnection>(std::move(stream), std::move(peer), context);
  try {
    co_await connection->run();
  } catch (const std::exception& error) {
    context.log.warn("connection_failed", {{"what", error.what()}});
  }
}

}  // namespace palpate

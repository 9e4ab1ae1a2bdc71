#pragma once
#include <atomic>
#include <cstdint>
#include <functional>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "service/server/http/problem.h"

namespace palpate {

/// A request, decoded, without anything of the library that read it.
struct HttpRequest {
  std::string method;                        ///< "GET"
  std::string path;                          ///< as sent, without the query
  std::vector<std::string> segments;         ///< of the path, percent-decoded
  std::map<std::string, std::string> query;  ///< percent-decoded
  std::string repeated;                      ///< a name of the query that comes twice; empty: none
  std::string content_type, accept, range, expect;
  std::string body;  ///< empty when it went to a BodySink
  /// True once the client has closed its end, and nobody waits for the answer.
  std::shared_ptr<const std::atomic<bool>> client_gone = std::make_shared<std::atomic<bool>>(false);

  std::string query_or(const std::string& name, const std::string& otherwise) const {
    const auto found = query.find(name);
    return found == query.end() ? otherwise : found->second;
  }
};

/// A piece of an answer that is sent as it is made.
struct Chunk {
  std::string data;
  bool last = false;
  bool broken = false;  ///< the rest can't be made: the connection ends without the closing chunk
};

/// Where a long answer comes from. next() is asked for one piece at a time; it calls `take` once, now or
/// later, on any thread. Destroyed early when the client has gone.
class BodySource {
 public:
  virtual ~BodySource() = default;
  virtual void next(std::function<void(Chunk)> take) = 0;
};

struct HttpResponse {
  unsigned status = 200;
  std::string type = "application/json";
  std::vector<std::pair<std::string, std::string>> headers;
  std::string body;
  std::shared_ptr<BodySource> source;          ///< in place of `body`
  std::optional<std::uint64_t> source_length;  ///< bytes of `source`, where they are known beforehand

  HttpResponse() = default;
  HttpResponse(unsigned code, std::string json) : status(code), body(std::move(json)) {}
  HttpResponse(const Problem& problem)
      : status(problem.status),
        type("application/problem+json"),
        body(problem.json()) {  // NOLINT(google-explicit-constructor)
    if (status == 503) headers.emplace_back("Retry-After", "1");
    if (status == 401) headers.emplace_back("WWW-Authenticate", "Bearer");
    if (status == 426) {  // RFC 9110, 15.5.22 and 7.8
      headers.emplace_back("Upgrade", "websocket");
      headers.emplace_back("Connection", "Upgrade");
    }
  }
};

/// Sends the answer; must be called exactly once, on any thread.
using Reply = std::function<void(HttpResponse)>;

/// Takes a body piece by piece, for what must never be in memory as a whole.
class BodySink {
 public:
  virtual ~BodySink() = default;
  virtual std::optional<Problem> write(std::string_view piece) = 0;
  virtual void finish(Reply reply) = 0;
};

/// A message of a WebSocket; its two parts are sent as one. The second may be shared by many connections.
struct SocketMessage {
  std::string head;
  std::shared_ptr<const std::string> tail;
  bool binary = false;
  bool close = false;         ///< the last one
  std::uint16_t code = 1000;  ///< of that close (RFC 6455, 7.4.1)
};

/// One end of a WebSocket conversation. All calls come from the connection's own strand, one at a time.
class SocketHandler {
 public:
  virtual ~SocketHandler() = default;
  /// `wake` may be called on any thread, at any time, also when the connection is gone: next() is then asked
  /// again.
  virtual void start(std::function<void()> wake) = 0;
  virtual void message(std::string_view data, bool binary) = 0;
  /// What to send now, if anything. Asked again once that has been sent, so who is slow simply misses what a
  /// newer message overtook.
  virtual std::optional<SocketMessage> next() = 0;
  /// The server stops: what is said before the farewell, in place of anything that next() would say. Asked
  /// once.
  virtual std::optional<SocketMessage> last_words() { return std::nullopt; }
  virtual void closed() noexcept = 0;
};

/// Splits and decodes a request's target ("/v1/scenes/a%2Fb?wait=3"). Nothing: not a path, a bad percent
/// sign, a zero byte.
bool decode_target(std::string_view target, HttpRequest& request);

/// Without blanks and tabs at either end (RFC 9110's optional white space).
std::string_view without_blanks(std::string_view text);

/// Of "Application/JSON; charset=utf-8": "application/json".
std::string media_type(std::string_view content_type);

/// Whether an Accept field names `type` and wants it no less than `otherwise`, which is what is sent without
/// being named (RFC 9110, 12.5.1). Both in small letters.
bool prefers(std::string_view accept, std::string_view type, std::string_view otherwise);

/// Undoes percent-encoding. False: an escape that is none, or a zero byte.
bool percent_decode(std::string_view text, std::string& out);

}  // namespace palpate

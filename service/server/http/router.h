#pragma once
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <variant>
#include <vector>

#include "service/server/http/http_message.h"

namespace palpate {

/// What answers one method of one path.
struct Route {
  std::string method{};
  std::string pattern{};                  ///< "v1/scenes/*/query": `*` is any one segment
  bool open = false;                      ///< needs no token
  std::vector<std::string> parameters{};  ///< of the target's query; others are refused, but for an open one
  std::size_t body_limit = 0;             ///< bytes of a body that is read whole; 0: none is wanted
  std::function<void(HttpRequest, Reply)> handle{};
  /// For bodies that are streamed; asked when the media type is `sink_type`.
  std::string sink_type{};
  std::size_t sink_limit = 0;
  std::function<std::unique_ptr<BodySink>(const HttpRequest&)> sink{};
  /// For a WebSocket in place of `handle`.
  std::function<std::variant<std::shared_ptr<SocketHandler>, Problem>(const HttpRequest&)> socket{};
};

/// Why the query of a request's target is none that the route takes.
std::optional<Problem> refuse_parameters(const Route& route, const HttpRequest& request);

/// Finds the route of a request. Fixed after the start, so any thread may ask.
class Router {
 public:
  void add(Route route) { routes_.push_back(std::move(route)); }
  /// 404 when no path fits, 405 (`allowed` filled) when no method does. HEAD is answered as GET.
  std::variant<const Route*, Problem> find(const HttpRequest& request, std::string& allowed) const;

 private:
  std::vector<Route> routes_;
};

}  // namespace palpate

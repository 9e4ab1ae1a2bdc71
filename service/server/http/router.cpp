#include "service/server/http/router.h"

#include <algorithm>

#include "model/scene/scene_json.h"
#include "service/server/http/json_input.h"

namespace palpate {
namespace {

bool fits(std::string_view pattern, const std::vector<std::string>& segments) {
  std::size_t i = 0;
  while (!pattern.empty()) {
    const auto slash = pattern.find('/');
    const std::string_view wanted = pattern.substr(0, slash);
    if (wanted == "**") return true;
    if (i == segments.size() || (wanted != "*" && wanted != segments[i])) return false;
    ++i;
    pattern = slash == std::string_view::npos ? std::string_view{} : pattern.substr(slash + 1);
  }
  return i == segments.size();
}

}  // namespace

std::optional<Problem> refuse_parameters(const Route& route, const HttpRequest& request) {
  if (route.open) return std::nullopt;  // probes and browsers add what they like, and nothing depends on it
  if (!request.repeated.empty())
    return bad_request("the parameter \"" + shown_text(request.repeated) + "\" comes twice",
                       shown_text(request.repeated));
  for (const auto& [name, ignored] : request.query) {
    if (std::find(route.parameters.begin(), route.parameters.end(), name) != route.parameters.end()) continue;
    return bad_request(
        "unknown parameter \"" + shown_text(name) + "\"; " +
            (route.parameters.empty()
                 ? "'" + shown_text(request.path) + "' takes none"
                 : "the nearest known one is \"" + nearest_word(name.substr(0, 40), route.parameters) + "\""),
        shown_text(name));
  }
  return std::nullopt;
}

std::variant<const Route*, Problem> Router::find(const HttpRequest& request, std::string& allowed) const {
  const std::string& method = request.method == "HEAD" ? "GET" : request.method;
  for (const Route& route : routes_) {
    if (!fits(route.pattern, request.segments)) continue;
    if (route.method == method) return &route;
    if (allowed.find(route.method) == std::string::npos)
      allowed += (allowed.empty() ? "" : ", ") + route.method + (route.method == "GET" ? ", HEAD" : "");
  }
  if (allowed.empty())
    return Problem{404, "not-found", "there is nothing at '" + shown_text(request.path) + "'", ""};
  return Problem{
      405, "method",
      shown_text(request.method) + " is not for '" + shown_text(request.path) + "'; " + allowed + " is", ""};
}

}  // namespace palpate

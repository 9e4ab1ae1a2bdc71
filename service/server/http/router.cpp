#include "service/server/http/router.h"

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

std::variant<const Route*, Problem> Router::find(const HttpRequest& request, std::string& allowed) const {
  const std::string& method = request.method == "HEAD" ? "GET" : request.method;
  for (const Route& route : routes_) {
    if (!fits(route.pattern, request.segments)) continue;
    if (route.method == method) return &route;
    if (allowed.find(route.method) == std::string::npos)
      allowed += (allowed.empty() ? "" : ", ") + route.method;
  }
  if (allowed.empty())
    return Problem{404, "not-found", "there is nothing at '" + shown_text(request.path) + "'", ""};
  return Problem{
      405, "method",
      shown_text(request.method) + " is not for '" + shown_text(request.path) + "'; " + allowed + " is", ""};
}

}  // namespace palpate

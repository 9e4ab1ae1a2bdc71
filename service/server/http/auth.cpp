#include "service/server/http/auth.h"

#include <algorithm>
#include <cctype>

#include "service/server/http/json_input.h"
#include "service/server/scenes/content_hash.h"

namespace palpate {
namespace {

bool ours(const AccessRules& rules, const std::string& name) {
  return !name.empty() && std::find(rules.hosts.begin(), rules.hosts.end(), name) != rules.hosts.end();
}

/// The token of "Bearer TOKEN", or of a subprotocol "palpate.token.TOKEN".
std::string_view token_of(const AccessFields& fields) {
  constexpr std::string_view kBearer = "bearer ", kSubprotocol = "palpate.token.";
  const std::string_view field = fields.authorization;
  if (field.size() > kBearer.size() &&
      std::equal(kBearer.begin(), kBearer.end(), field.begin(),
                 [](char a, char b) { return a == std::tolower(static_cast<unsigned char>(b)); }))
    return field.substr(kBearer.size());
  std::string_view rest = fields.subprotocols;
  while (!rest.empty()) {
    const auto comma = rest.find(',');
    std::string_view word = rest.substr(0, comma);
    while (!word.empty() && word.front() == ' ') word.remove_prefix(1);
    while (!word.empty() && word.back() == ' ') word.remove_suffix(1);
    if (word.starts_with(kSubprotocol)) return word.substr(kSubprotocol.size());
    rest = comma == std::string_view::npos ? std::string_view{} : rest.substr(comma + 1);
  }
  return {};
}

/// "HTTP://Name:80" → "name": lower case, without scheme and the usual ports.
std::string authority(std::string_view text) {
  if (const auto scheme = text.find("://"); scheme != std::string_view::npos) text.remove_prefix(scheme + 3);
  if (text.ends_with(":80")) text.remove_suffix(3);
  if (text.ends_with(":443")) text.remove_suffix(4);
  std::string out(text);
  for (char& c : out) c = static_cast<char>(std::tolower(static_cast<unsigned char>(c)));
  return out;
}

}  // namespace

std::string host_name(std::string_view text) {
  std::size_t end = text.find(':');
  if (!text.empty() && text.front() == '[') {
    end = text.find(']');
    if (end == std::string_view::npos) return {};
    ++end;
    if (end < text.size() && text[end] != ':') return {};
  }
  if (end != std::string_view::npos && end < text.size())
    for (const char c : text.substr(end + 1))
      if (c < '0' || c > '9') return {};
  std::string name(text.substr(0, end));
  for (char& c : name) c = static_cast<char>(std::tolower(static_cast<unsigned char>(c)));
  return name;
}

std::optional<Problem> refuse_access(const AccessRules& rules, const AccessFields& fields, bool open) {
  if (!ours(rules, host_name(fields.host)))
    return Problem{403, "foreign-host",
                   "the host '" + shown_text(fields.host) + "' is none of this server's (see --host)",
                   "Host"};
  // A page of another port of this machine is another's page.
  if (!fields.origin.empty() && authority(fields.origin) != authority(fields.host))
    return Problem{403, "foreign-origin", "pages of '" + shown_text(fields.origin) + "' may not ask here",
                   "Origin"};
  if (!open && !rules.token.empty() && !same_secret(token_of(fields), rules.token))
    return Problem{401, "token", "a token is wanted: Authorization: Bearer TOKEN", "Authorization"};
  return std::nullopt;
}

}  // namespace palpate

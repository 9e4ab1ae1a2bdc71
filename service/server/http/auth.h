#pragma once
#include <string>
#include <string_view>
#include <vector>

#include "service/server/http/http_message.h"

namespace palpate {

/// Who may ask, by the head of a request alone.
struct AccessRules {
  std::vector<std::string> hosts;  ///< names that are ours, lower case, without a port
  std::string token;               ///< empty: none is wanted
};

/// The head's fields that decide; empty where missing.
struct AccessFields {
  std::string_view host, origin, authorization, subprotocols;
};

/// The name of a Host field, lower case, without the port; "" when it is none. `[::1]` keeps its brackets.
std::string host_name(std::string_view text);

/// Why a request may not go on, if it may not: 403 for a foreign Host or Origin, 401 for the token where one
/// is wanted and the route isn't open.
std::optional<Problem> refuse_access(const AccessRules& rules, const AccessFields& fields, bool open);

}  // namespace palpate

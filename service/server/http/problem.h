#pragma once
#include <string>

#include "model/result.h"

namespace palpate {

/// Why a request was refused, as problem+json (RFC 9457) tells it.
struct Problem {
  unsigned status = 500;
  std::string type = "internal";  ///< last word of urn:palpate:problem:…
  std::string detail;             ///< one sentence with the value and its limit
  std::string field;              ///< the part of the request at fault; empty: none

  /// One JSON object. Bytes of a stranger that are no UTF-8 are replaced.
  std::string json() const;
};

/// A bad value of the request's own: 400.
Problem bad_request(std::string detail, std::string field = {});

/// What the library said no to: 400 for a bad value, 409 for a device that isn't there, 500 for anything
/// else.
Problem problem_of(const Error& error, std::string field = {});

}  // namespace palpate

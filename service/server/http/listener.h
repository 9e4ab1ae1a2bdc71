#pragma once
#include <atomic>
#include <cstdint>
#include <functional>
#include <memory>
#include <string>

#include "model/result.h"
#include "service/server/http/auth.h"
#include "service/server/http/limits.h"
#include "service/server/http/router.h"
#include "service/server/log.h"
#include "service/server/metrics.h"

namespace palpate {

struct ListenOptions {
  std::string address = "127.0.0.1";  ///< numeric
  std::uint16_t port = 8090;          ///< 0: any free one
  std::string certificate, key;       ///< PEM files; empty: without TLS
};

/// Whether only this machine reaches the address.
bool is_loopback(const std::string& address);

/// Takes connections on threads of its own and answers them by the router. All it refers to outlives it.
class Listener {
 public:
  Listener(const Router& router, const AccessRules& rules, const ServerLimits& limits, Metrics& metrics,
           Log& log);
  ~Listener();

  /// Error kBadValue: the address can't be had, or the certificate or key can't be used.
  Result<void> start(const ListenOptions& options);
  std::uint16_t port() const;
  /// Takes no more connections and ends the WebSockets with the message of their handlers; waits until all
  /// are gone, `grace_s` at most.
  void stop(double grace_s);

 private:
  struct State;
  std::unique_ptr<State> state_;
};

}  // namespace palpate

#pragma once
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "service/cli/cli.h"
#include "service/server/http/limits.h"
#include "service/server/http/listener.h"

namespace palpate {

/// What `palpate serve` was told.
struct ServeOptions {
  std::string listen = "127.0.0.1:8090";
  std::string root;   ///< folder of scenes and runs; empty: none
  std::string spool;  ///< folder for uploads; empty: a fresh one, removed at the end
  std::string token_file, certificate, key;
  std::vector<std::string> hosts;  ///< further names of this server
  std::string backend;             ///< as SceneOptions::backend
  std::string log;                 ///< "plain" or "json"; empty: plain at a terminal
  ServerLimits limits;
};

/// Runs until SIGINT or SIGTERM, then ends sessions with zero force, tells clients, and returns. Errors:
/// kUsage beyond loopback without token and TLS; kBadValue for an address, folder or file.
Result<void> serve(const ServeOptions& options, const Parts& parts);

}  // namespace palpate

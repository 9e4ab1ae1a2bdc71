#include "service/server/server.h"

#include <poll.h>
#include <signal.h>
#include <stdlib.h>
#include <unistd.h>

#include <charconv>
#include <filesystem>
#include <fstream>
#include <nlohmann/json.hpp>
#include <thread>

#include "service/cli/console.h"
#include "service/server/assemblies/assembly_routes.h"
#include "service/server/info_routes.h"
#include "service/server/queries/batch_queue.h"
#include "service/server/queries/path_route.h"
#include "service/server/queries/query_route.h"
#include "service/server/queries/worker_pool.h"
#include "service/server/scenes/drawing_routes.h"
#include "service/server/scenes/scene_routes.h"
#include "service/server/scenes/scene_store.h"
#include "service/server/sessions/remote_loops.h"
#include "service/server/sessions/run_routes.h"
#include "service/server/sessions/session_host.h"

namespace palpate {
namespace {

namespace fs = std::filesystem;

constexpr double kGrace = 5;                ///< s for answers under way and farewells; chosen
constexpr std::size_t kShortestToken = 16;  ///< characters; chosen
constexpr int kWorkers = 2;

/// "127.0.0.1:8090", "[::1]:8090".
Result<ListenOptions> parse_listen(const std::string& text) {
  const auto colon = text.rfind(':');
  ListenOptions out;
  if (colon == std::string::npos || colon == 0)
    return bad_value("--listen '" + text + "' is no ADDRESS:PORT");
  out.address = text.substr(0, colon);
  if (out.address.front() == '[' && out.address.back() == ']')
    out.address = out.address.substr(1, out.address.size() - 2);
  if (out.address == "localhost") out.address = "127.0.0.1";
  const auto [stop, error] = std::from_chars(text.data() + colon + 1, text.data() + text.size(), out.port);
  if (error != std::errc() || stop != text.data() + text.size())
    return bad_value("--listen '" + text + "': the port is no number from 0 to 65535");
  return out;
}

Result<std::string> read_token(const std::string& path) {
  if (path.empty()) return std::string();
  std::ifstream in(path);
  std::string token;
  if (!in || !std::getline(in, token)) return bad_value("--token-file " + path + ": the file can't be read");
  while (!token.empty() && (token.back() == '\r' || token.back() == ' ')) token.pop_back();
  if (token.size() < kShortestToken)
    return bad_value("--token-file " + path + ": the token has " + std::to_string(token.size()) +
                     " characters, at least 16 are wanted");
  for (const char c : token)
    if (!((c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || (c >= '0' && c <= '9') || c == '-' ||
          c == '_' || c == '.' || c == '~'))
      return bad_value("--token-file " + path +
                       ": the token has a character that is no letter, digit, '-', '_', '.' or '~'");
  return token;
}

/// The folder of uploads, made if need be; one of our own is removed in the end, with all that is in it.
class Spool {
 public:
  static Result<std::unique_ptr<Spool>> open(const std::string& wanted) {
    auto spool = std::unique_ptr<Spool>(new Spool);
    std::error_code error;
    if (!wanted.empty()) fs::create_directories(wanted, error);
    std::string pattern =
        (wanted.empty() ? fs::temp_directory_path(error) : fs::path(wanted)) / "palpate-uploads-XXXXXX";
    if (error || !::mkdtemp(pattern.data()))
      return bad_value("--spool " + (wanted.empty() ? pattern : wanted) +
                       ": no folder for uploads can be made there");
    spool->path_ = fs::canonical(pattern, error);
    return spool;
  }
  ~Spool() {
    std::error_code ignored;
    if (!path_.empty()) fs::remove_all(path_, ignored);
  }
  const fs::path& path() const { return path_; }

 private:
  Spool() = default;
  fs::path path_;
};

AccessRules access_rules(const ListenOptions& listen, const std::vector<std::string>& hosts,
                         std::string token) {
  AccessRules rules;
  rules.token = std::move(token);
  rules.hosts = {"localhost", "127.0.0.1", "[::1]"};
  rules.hosts.push_back(listen.address.find(':') == std::string::npos ? listen.address
                                                                      : "[" + listen.address + "]");
  for (const std::string& host : hosts) rules.hosts.push_back(host_name(host));
  return rules;
}

/// Says "stopped" when all that may say something is gone: it stands behind the log, before everything else.
struct LastWord {
  Log& log;
  bool wanted = false;
  ~LastWord() {
    if (wanted) log.info("stopped", nlohmann::ordered_json::object());
  }
};

}  // namespace

Result<void> serve(const ServeOptions& options, const Parts& parts) {
  Result<ListenOptions> listen = parse_listen(options.listen);
  if (!listen) return listen.error();
  listen->certificate = options.certificate;
  listen->key = options.key;
  if (options.certificate.empty() != options.key.empty())
    return Error{ErrorCode::kUsage, "--tls-certificate and --tls-key go together"};
  if (!is_loopback(listen->address) && (options.token_file.empty() || options.certificate.empty()))
    return Error{ErrorCode::kUsage,
                 "--listen " + options.listen +
                     " is beyond this machine: that needs --token-file, --tls-certificate and --tls-key"};
  Result<std::string> token = read_token(options.token_file);
  if (!token) return token.error();
  std::error_code error;
  fs::path root;
  if (!options.root.empty()) {
    root = fs::canonical(options.root, error);
    if (error || !fs::is_directory(root, error))
      return bad_value("--root " + options.root + ": there is no such folder");
  }
  auto spool = Spool::open(options.spool);
  if (!spool) return spool.error();
  catch_interrupts();
  ::signal(SIGPIPE, SIG_IGN);
  ::signal(SIGXFSZ, SIG_IGN);
  // Back ends are made while threads run, and a driver reads this when its first device is looked for
  // (GpuOptions::inline_execution).
  ::setenv("LP_NUM_THREADS", "0", 0);

  // In the order in which they may refer to each other; destroyed from the last to the first.
  const bool plain = options.log == "plain" || (options.log.empty() && ::isatty(STDERR_FILENO) == 1);
  Log log(plain ? Log::Form::kPlain : Log::Form::kJson, Console::quiet());
  LastWord last_word{log};
  Metrics metrics;
  const ServerLimits& limits = options.limits;
  const AccessRules rules = access_rules(*listen, options.hosts, std::move(*token));
  Router router;
  Listener listener(router, rules, limits, metrics, log);
  SceneStore store(parts, options.backend, limits, metrics, log);
  AssemblyStore assemblies(limits);
  BatchQueue batches(store, limits, metrics);
  RemoteLoops loops(limits, metrics);
  SessionHost sessions(parts, store, limits, metrics, log, root);
  WorkerPool workers(kWorkers);
  std::atomic<bool> stopping{false};
  add_info_routes(router, {.parts = parts,
                           .limits = limits,
                           .metrics = metrics,
                           .store = store,
                           .sessions = sessions,
                           .workers = workers,
                           .stopping = stopping,
                           .backend = options.backend});
  add_scene_routes(router, store, workers, metrics, limits, root, (*spool)->path());
  add_assembly_routes(router, assemblies, store, workers, metrics, limits, root, (*spool)->path());
  add_query_route(router, store, batches, workers, limits);
  add_path_route(router, store, workers, limits, stopping);
  add_session_routes(router, sessions, workers, limits);
  add_haptic_route(router, store, loops);
  add_drawing_routes(router, store, workers, limits);
  add_run_routes(router, workers, root);

  if (auto started = listener.start(*listen); !started) return started;
  const std::string shown =
      (listen->address.find(':') == std::string::npos ? listen->address : "[" + listen->address + "]") + ":" +
      std::to_string(listener.port());
  const std::string url = (options.certificate.empty() ? "http://" : "https://") + shown + "/";
  log.info("listening", {{"address", shown},
                         {"tls", !options.certificate.empty()},
                         {"token", !rules.token.empty()},
                         {"root", root.string()},
                         {"url", url}});
  if (plain && !Console::quiet())
    Console().note("the viewer is at " + url + " for a browser; Ctrl-C ends the server");
  while (!interrupted()) ::poll(nullptr, 0, 50);

  log.info("stopping", nlohmann::ordered_json::object());
  stopping = true;
  sessions.stop_all();  // zero force before anything else
  store.cancel();
  listener.stop(kGrace);
  last_word.wanted = true;
  return {};
}

}  // namespace palpate

#pragma once
#include <filesystem>
#include <list>
#include <memory>
#include <mutex>
#include <optional>
#include <string>
#include <variant>

#include "service/cli/cli.h"
#include "service/server/http/limits.h"
#include "service/server/http/router.h"
#include "service/server/log.h"
#include "service/server/metrics.h"
#include "service/server/queries/worker_pool.h"
#include "service/server/scenes/scene_store.h"

namespace palpate {

/// Sessions: devices of this machine, each with its 1 kHz loop, collision worker and recording thread. Back
/// ends are shared by turns.
class SessionHost {
 public:
  /// All outlive this. `root`: where recordings go; empty: nowhere.
  SessionHost(const Parts& parts, SceneStore& store, const ServerLimits& limits, Metrics& metrics, Log& log,
              std::filesystem::path root);
  ~SessionHost();  ///< stops all

  struct Request {
    std::string scene, device, record;
    std::optional<double> duration_s;
  };
  /// The Session, as JSON, once its device is open.
  std::variant<std::string, Problem> start(const Request& request);
  std::optional<std::string> view(const std::string& id) const;
  std::string all() const;  ///< {"sessions":[…]}
  std::variant<std::string, Problem> set_paused(const std::string& id, bool paused);
  std::variant<std::string, Problem> stop(
      const std::string& id);  ///< waits for zero force and a closed device
  std::variant<std::shared_ptr<SocketHandler>, Problem> watch(const std::string& id, bool binary);
  /// Ends every session with zero force; waits.
  void stop_all();
  std::vector<Metrics::Gauge> gauges() const;

 private:
  struct Session;
  std::shared_ptr<Session> find(const std::string& id) const;
  void forget_old();

  const Parts& parts_;
  SceneStore& store_;
  const ServerLimits& limits_;
  Metrics& metrics_;
  Log& log_;
  std::filesystem::path root_;
  mutable std::mutex mutex_;
  std::list<std::shared_ptr<Session>> sessions_;
  std::uint64_t count_ = 0;
  bool closed_ = false;
};

/// /v1/sessions and what lies below.
void add_session_routes(Router& router, SessionHost& sessions, WorkerPool& workers,
                        const ServerLimits& limits);

}  // namespace palpate

#pragma once
#include <condition_variable>
#include <deque>
#include <memory>
#include <mutex>
#include <thread>

#include "service/server/http/http_message.h"
#include "service/server/http/limits.h"
#include "service/server/http/router.h"
#include "service/server/metrics.h"
#include "service/server/scenes/scene_store.h"

namespace palpate {

/// Answers the poses of all remote loops on one thread, each loop's newest alone, by turns. A loop remembers
/// what the frame before held, as a session's does.
class RemoteLoops {
 public:
  RemoteLoops(const ServerLimits& limits, Metrics& metrics);
  ~RemoteLoops();
  RemoteLoops(const RemoteLoops&) = delete;
  RemoteLoops& operator=(const RemoteLoops&) = delete;

  /// The server's end of a connection (docs/SERVICE.md, "Haptic"); 503 when there are too many.
  std::variant<std::shared_ptr<SocketHandler>, Problem> open(SceneUse scene, const std::string& id);

 private:
  struct Loop;
  class Socket;
  void submit(const std::shared_ptr<Loop>& loop);
  void run();
  void answer(Loop& loop);

  const ServerLimits& limits_;
  Metrics& metrics_;
  std::mutex mutex_;
  std::condition_variable work_;
  std::deque<std::shared_ptr<Loop>> waiting_;  ///< loops with a pose that nobody has looked at
  bool stop_ = false;
  std::thread thread_;
};

/// /v1/scenes/{id}/haptic.
void add_haptic_route(Router& router, SceneStore& store, RemoteLoops& loops);

}  // namespace palpate

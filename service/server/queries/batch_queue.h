#pragma once
#include <chrono>
#include <condition_variable>
#include <deque>
#include <functional>
#include <list>
#include <memory>
#include <mutex>
#include <optional>
#include <string>
#include <thread>
#include <vector>

#include "model/lattice/pose.h"
#include "service/server/http/http_message.h"
#include "service/server/http/limits.h"
#include "service/server/metrics.h"
#include "service/server/scenes/scene_store.h"

namespace palpate {

/// What a query asked for.
struct BatchRequest {
  SceneUse scene;
  std::vector<Pose> poses;
  bool sets = true;
  bool names = false;                ///< the parts that touch, by their paths
  bool any = false;                  ///< touch or not, a line a pose, and nothing else
  bool clearance = false;            ///< how far it is, a line a pose, and nothing else
  std::optional<double> within_m{};  ///< with `clearance`: lines of poses that are no further, and no others
  bool binary = false;               ///< 64 bytes a pose instead of JSON lines
};

/// Answers the poses of all queries on one thread, a slice of each by turns. Beside loops on the same scene
/// it uses a back end of its own, or, where there is no room for one, lets them go first between any two
/// poses. A query whose client reads slowly is set aside until it has.
class BatchQueue {
 public:
  BatchQueue(SceneStore& store, const ServerLimits& limits, Metrics& metrics);
  ~BatchQueue();  ///< what is under way breaks off
  BatchQueue(const BatchQueue&) = delete;
  BatchQueue& operator=(const BatchQueue&) = delete;

  /// Replies once the first poses are answered, or with a problem.
  void add(BatchRequest request, Reply reply);

 private:
  struct Batch;
  class Source;
  void run();
  void answer_slice(Batch& batch);
  Result<std::size_t> answer_some(Batch& batch, CollisionBackend& backend, bool several, std::size_t most);
  Result<void> touch_slice(Batch& batch);
  Result<void> clearance_slice(Batch& batch, std::chrono::steady_clock::time_point start);
  void resume(const std::shared_ptr<Batch>& batch);

  SceneStore& store_;
  const ServerLimits& limits_;
  Metrics& metrics_;
  std::mutex mutex_;
  std::condition_variable work_;
  std::list<std::shared_ptr<Batch>> ring_;  ///< next first
  bool stop_ = false;
  std::thread thread_;
};

}  // namespace palpate

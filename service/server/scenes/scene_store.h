#pragma once
#include <chrono>
#include <condition_variable>
#include <cstdint>
#include <functional>
#include <list>
#include <map>
#include <memory>
#include <mutex>
#include <optional>
#include <string>
#include <thread>
#include <variant>
#include <vector>

#include "service/cli/cli.h"
#include "service/cli/scene_host.h"
#include "service/server/http/limits.h"
#include "service/server/http/problem.h"
#include "service/server/log.h"
#include "service/server/metrics.h"
#include "service/server/queries/turns.h"
#include "service/server/scenes/scene_content.h"

namespace palpate {

enum class SceneState : std::uint8_t { kQueued, kPreparing, kReady, kFailed, kEvicted };

/// A ready scene in use. While one lives the scene is not evicted; while a loop's lives it is not deleted
/// either.
class SceneLease {
 public:
  struct Count {
    std::atomic<int> all{0}, loops{0};
    Turns turns;
  };
  SceneLease(std::shared_ptr<HostedScene> scene, std::shared_ptr<Count> count, bool loop)
      : scene_(std::move(scene)), count_(std::move(count)), loop_(loop) {
    ++count_->all;
    if (loop_) ++count_->loops;
  }
  ~SceneLease() {
    scene_.reset();  // its memory is free before anybody counts on that
    if (loop_) --count_->loops;
    --count_->all;
  }
  SceneLease(const SceneLease&) = delete;
  SceneLease& operator=(const SceneLease&) = delete;
  int loops() const { return count_->loops; }     ///< sessions and haptic connections on the scene
  Turns& turns() const { return count_->turns; }  ///< at the scene's back end
  HostedScene& operator*() const { return *scene_; }
  HostedScene* operator->() const { return scene_.get(); }

 private:
  std::shared_ptr<HostedScene> scene_;
  std::shared_ptr<Count> count_;
  bool loop_;
};
using SceneUse = std::shared_ptr<SceneLease>;

/// A back end that no loop uses, while this lives.
struct Aside {
  std::unique_lock<std::mutex> lock;
  CollisionBackend* backend = nullptr;  ///< null: there is no room for one
};

/// All scenes of a server: queued, prepared one after the other on a thread of its own, kept within the
/// memory budget, evicted when unused longest. Any thread may call anything; nothing here waits for a
/// preparation but the destructor, which cancels it.
class SceneStore {
 public:
  struct View {
    SceneState state = SceneState::kQueued;
    std::uint64_t version = 0;  ///< grows with every change
    std::string json;
  };

  SceneStore(const Parts& parts, std::string backend, const ServerLimits& limits, Metrics& metrics, Log& log);
  ~SceneStore();
  SceneStore(const SceneStore&) = delete;
  SceneStore& operator=(const SceneStore&) = delete;

  /// Makes the scene known and queues it, unless it is known and not failed. An upload's folder belongs to
  /// the store from here on, whatever comes.
  std::variant<View, Problem> add(SceneContent content);
  std::optional<View> view(const std::string& id) const;
  std::vector<View> all() const;
  std::string name(const std::string& id) const;  ///< for people; the id of a scene that is not known
  std::optional<Problem> remove(const std::string& id);
  /// The scene, if it is ready. An evicted one is queued again: 503.
  std::variant<SceneUse, Problem> use(const std::string& id, bool loop);

  /// A back end of the scene for who would hold up its loops otherwise: prepared when it is first asked for,
  /// as long as that takes, within the memory budget. It goes with the scene.
  Aside aside(const SceneLease& scene);

  /// Preparations under way end, and none begins.
  void cancel() noexcept { stopping_ = true; }

  /// `changed` is called after any scene's change, on any thread, until the returned handle is gone. It must
  /// not call back.
  std::shared_ptr<void> listen(std::function<void()> changed);

  std::vector<Metrics::Gauge> gauges() const;

 private:
  struct Entry;
  void prepare_loop();
  void prepare_one(const std::shared_ptr<Entry>& entry);
  void finish(const std::shared_ptr<Entry>& entry, std::shared_ptr<HostedScene> prepared,
              std::uint64_t bytes);
  void changed(Entry& entry);  // under the mutex
  void notify();
  bool make_memory_locked(std::uint64_t bytes, std::vector<std::shared_ptr<HostedScene>>& evicted);
  std::optional<Problem> make_room_locked(std::uint64_t disk_bytes,
                                          std::vector<std::filesystem::path>& garbage);
  std::shared_ptr<Entry> find_locked(const std::string& id) const;
  View view_of(const Entry& entry) const;

  const Parts& parts_;
  std::string backend_;
  ServerLimits limits_;
  Metrics& metrics_;
  Log& log_;

  mutable std::mutex mutex_;
  std::condition_variable work_;
  std::list<std::shared_ptr<Entry>> entries_;  ///< longest unused first
  std::list<std::shared_ptr<Entry>> queue_;
  bool stop_ = false;
  std::atomic<bool> stopping_{false};  ///< cancel() was called
  struct Listeners {
    std::mutex mutex;
    std::list<std::function<void()>> calls;
  };
  std::shared_ptr<Listeners> listeners_ =
      std::make_shared<Listeners>();  ///< shared with the handles, which may outlive this
  std::thread thread_;
};

}  // namespace palpate

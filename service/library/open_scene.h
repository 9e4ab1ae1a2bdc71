#pragma once
#include <sys/types.h>

#include <condition_variable>
#include <functional>
#include <memory>
#include <mutex>
#include <string>
#include <string_view>
#include <vector>

#include "model/shared_backend.h"
#include "service/cli/scene_host.h"
#include "service/library/failure.h"
#include "service/queries/side_by_side.h"

namespace palpate::library {

/// A prepared scene that any thread may ask.
class OpenScene {
 public:
  explicit OpenScene(std::unique_ptr<HostedScene> hosted);
  /// In a child of fork() the engine's threads are not there, so nothing can be taken down.
  static void close(OpenScene* scene) noexcept;

  const HostedScene& hosted() const { return *hosted_; }
  const SceneGeometry& geometry() const { return hosted_->loaded.geometry; }
  const std::string& hash() const { return hash_; }
  const std::string& description() const { return description_; }
  const std::string& engine() const { return engine_; }

  /// Error: this process did not open the scene.
  Result<void> usable() const;

  using Ask = std::function<Result<void>(CollisionBackend& backend)>;
  /// Asks the engine itself, whose batches take all processors: one caller after the other.
  Result<void> ask(const Ask& asking);
  /// Asks whoever is free, the engine or a fellow of it; as many callers at once as there are processors, if
  /// the engine can have fellows. `asking` may be called again, of the engine, when a fellow fails.
  Result<void> ask_any(const Ask& asking);

  /// Does pieces 0 … count − 1 side by side, in any order, as ask_any(). `look` is called by this thread
  /// between two of its pieces; an error ends the whole, as a piece's does.
  Result<void> ask_side_by_side(std::size_t count, const BackendWork& work,
                                const std::function<Result<void>(std::size_t done)>& look);

 private:
  struct Giving {
    OpenScene* scene;
    void operator()(CollisionBackend* asked) const noexcept { scene->give(*asked); }
  };
  /// Somebody to ask, until it is given back.
  using Turn = std::unique_ptr<CollisionBackend, Giving>;

  Turn take_engine();
  Turn take_any();
  Turn take_fellow();  ///< null: there is none to be had
  CollisionBackend* fellow(std::unique_lock<std::mutex>& lock);
  void give(const CollisionBackend& asked) noexcept;
  Turn turn(CollisionBackend* asked) { return Turn(asked, Giving{this}); }

  std::unique_ptr<HostedScene> hosted_;
  pid_t process_;
  std::string engine_, hash_, description_;

  std::mutex mutex_;
  std::condition_variable freed_;
  bool engine_taken_ = false;
  SharedBackend::Another another_;  ///< empty: the engine has no fellows, or no more
  std::vector<std::unique_ptr<CollisionBackend>> fellows_;
  std::vector<CollisionBackend*> free_;  ///< of these
};

/// Seven doubles as a pose. Error: kBadValue, with the pose's number.
Result<Pose> pose_at(const double* poses, std::size_t number);

/// PALPATE_ENGINE_… of an engine's name.
std::uint8_t engine_code(std::string_view name);

}  // namespace palpate::library

struct palpate_scene final : palpate::library::OpenScene {
  using OpenScene::OpenScene;
};

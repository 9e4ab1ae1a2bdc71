#pragma once
#include <functional>
#include <memory>
#include <mutex>
#include <optional>
#include <string>

#include "model/scene/plan.h"
#include "model/scene/scene.h"
#include "service/cli/cli.h"
#include "service/cli/console.h"

namespace palpate {

/// A scene, loaded and prepared on a back end. Never moves: the back end points into `loaded`.
struct HostedScene {
  LoadedScene loaded;
  std::unique_ptr<CollisionBackend> backend;
  std::unique_ptr<CollisionBackend> second;  ///< only if asked for; not prepared
  PlanDecision plan;
  /// One more, prepared, for who must not hold up loops that use the first (SceneStore::aside); null until it
  /// is wanted.
  std::unique_ptr<CollisionBackend> aside;
  bool aside_failed = false;         ///< it could not be prepared
  std::mutex aside_mutex;            ///< of the two; one query at a time
  double load_s = 0, prepare_s = 0;  ///< wall time, first-run shader compilation included
};

/// Who asks: it decides which facts the plan rests on.
enum class Purpose : std::uint8_t {
  kQuery,
  kSession,    ///< a device, and nobody who reads more than forces
  kRecording,  ///< a session whose frames are recorded
};

/// Who follows a preparation. All are called on the preparing thread.
struct PrepareWatch {
  std::function<void(const std::string& sentence)> note;
  std::function<void(const char* step)> step;
  Progress progress;
  /// Asked once the triangles are known and before the work begins; may be empty. An error ends the
  /// preparation.
  std::function<Result<void>(const LoadedScene& loaded)> admit;
  bool cached = true;  ///< false, for a stranger's scene: the cache's keys are no match for someone who wants
                       ///< two scenes to have the same
  std::string folder;  ///< files that a mesh names in turn must lie below it (model/mesh/confined_import.h);
                       ///< empty: anywhere
};

/// Reads the scene, chooses the back end, imports, decides the plan and prepares. Where `auto` finds a GPU,
/// the native engine is prepared as well, and the quicker of both stays (service/engine_times.h). Call before
/// any thread exists, or with LP_NUM_THREADS set: a Vulkan driver's settings are read from the environment.
Result<std::unique_ptr<HostedScene>> prepare_scene(const SceneOptions& options, Purpose purpose,
                                                   const Parts& parts, const PrepareWatch& watch);

/// The same of a scene that has been read: `options.scene` and `options.profile` say nothing.
Result<std::unique_ptr<HostedScene>> prepare_scene(Scene scene, const SceneOptions& options, Purpose purpose,
                                                   const Parts& parts, const PrepareWatch& watch);

/// The same with notes and progress on `console`.
Result<std::unique_ptr<HostedScene>> prepare_scene(const SceneOptions& options, Purpose purpose,
                                                   const Parts& parts, Console& console);

/// The same for the planner's questions (docs/EXACTNESS.md, section 10), which no force decides: whatever the
/// scene's profile, contact and depth are those of `refined`. `tolerance_m` > 0: all samples count.
Result<std::unique_ptr<HostedScene>> prepare_for_verdicts(SceneOptions options, double tolerance_m,
                                                          const Parts& parts, Console& console);

/// The engine that `name` asks for, for scenes of a profile; empty: of either. "auto" or empty: gpu on a GPU,
/// else cpu, with one sentence. What an engine can't do another does, but for gpu asked for by name. Error
/// kNoDevice: that, and there is no device.
Result<std::unique_ptr<CollisionBackend>> choose_backend(
    const std::string& name, std::optional<Profile> profile, const Parts& parts,
    const std::function<void(const std::string& sentence)>& note, bool cached = true);
Result<std::unique_ptr<CollisionBackend>> choose_backend(const std::string& name,
                                                         std::optional<Profile> profile, const Parts& parts,
                                                         Console& console);

}  // namespace palpate

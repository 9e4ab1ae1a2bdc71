#pragma once
#include <memory>
#include <string>

#include "model/plan.h"
#include "model/scene.h"
#include "service/cli.h"
#include "service/console.h"

namespace palpate {

/// A scene, loaded and prepared on a back end. Never moves: the back end points into `loaded`.
struct HostedScene {
  LoadedScene loaded;
  std::unique_ptr<CollisionBackend> backend;
  PlanDecision plan;
  double load_s = 0, prepare_s = 0;   ///< wall time, first-run shader compilation included
};

/// Who asks: it decides which facts the plan rests on.
enum class Purpose : std::uint8_t { kQuery, kSession };

/// Reads the scene, chooses the back end, imports, decides the plan and prepares, with progress on `console`.
/// Call before any thread exists.
Result<std::unique_ptr<HostedScene>> prepare_scene(const SceneOptions& options, Purpose purpose, const Parts& parts, Console& console);

/// gpu, else cpu with one sentence; or the one that `name` asks for. Error kNoDevice: gpu was asked for and there is none.
Result<std::unique_ptr<CollisionBackend>> choose_backend(const std::string& name, const Parts& parts, Console& console);

}  // namespace palpate

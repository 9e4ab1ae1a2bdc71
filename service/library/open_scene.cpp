#include "service/library/open_scene.h"

#include <fmt/format.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <nlohmann/json.hpp>

#include "model/cache/geometry_cache.h"
#include "model/processors.h"
#include "service/cli/pose_input.h"

namespace palpate::library {
namespace {

using Json = nlohmann::ordered_json;

Json row(const Vec3& v) { return {v.x, v.y, v.z}; }

Json body_json(const LatticeMesh& mesh, const MeshReport& report) {
  Json parts = Json::array();
  std::uint32_t first = 0;
  for (const MeshReport::Part& part : report.parts) {
    parts.push_back({{"path", part.path},
                     {"first_triangle", first},
                     {"triangles", part.triangles},
                     {"closed", part.closed},
                     {"box", {row(part.box_min_m), row(part.box_max_m)}}});
    first += part.triangles;
  }
  return {{"triangles", mesh.triangles.size()}, {"closed", mesh.closed}, {"parts", std::move(parts)}};
}

std::string hash_of(const LoadedScene& loaded) {
  KeyBuilder key;
  add_geometry(key, loaded.geometry);
  key.value(static_cast<std::uint8_t>(loaded.scene.response.profile));
  key.value(loaded.scene.response.stiffness_n_per_m);
  return key.finish().hex();
}

std::string describe(const HostedScene& hosted, const std::string& hash) {
  const LoadedScene& loaded = hosted.loaded;
  const SceneGeometry& geometry = loaded.geometry;
  const auto& [p, q] = loaded.scene.start;
  Json stages = Json::array();
  for (const PlanStage& stage : hosted.plan.stages)
    stages.push_back({{"stage", stage.stage},
                      {"kept", stage.kept},
                      {"reason", stage.reason},
                      {"memory_bytes", stage.memory_bytes}});
  const Json out{{"hash", hash},
                 {"engine", hosted.backend->name()},
                 {"device", hosted.backend->device()},
                 {"profile", loaded.scene.response.profile == Profile::kPaper ? "paper" : "refined"},
                 {"stiffness", loaded.scene.response.stiffness_n_per_m},
                 {"all_samples", geometry.contact_samples == 0},
                 {"step", geometry.lattice.step_m},
                 {"origin", row(geometry.lattice.origin_m)},
                 {"reach", geometry.lattice.step_m * kLatticeReach},
                 {"voxel_size", geometry.lattice.step_m * geometry.mockup_grid.size},
                 {"centre_of_mass", row(geometry.tool_gc_m)},
                 {"start", {p.x, p.y, p.z, q.x, q.y, q.z, q.w}},
                 {"static", body_json(geometry.mockup, geometry.mockup_report)},
                 {"tool", body_json(geometry.tool, geometry.tool_report)},
                 {"memory_bytes", hosted.backend->memory_bytes()},
                 {"plan", std::move(stages)},
                 {"warnings", loaded.scene.warnings}};
  return out.dump(-1, ' ', false, Json::error_handler_t::replace);
}

}  // namespace

OpenScene::OpenScene(std::unique_ptr<HostedScene> hosted)
    : hosted_(std::move(hosted)),
      process_(::getpid()),
      engine_(hosted_->backend->name()),
      hash_(hash_of(hosted_->loaded)),
      description_(describe(*hosted_, hash_)) {
  if (const auto* shared = dynamic_cast<const SharedBackend*>(hosted_->backend.get()))
    another_ = shared->another();
}

void OpenScene::close(OpenScene* scene) noexcept {
  if (scene && scene->process_ != ::getpid()) return;
  delete scene;
}

Result<void> OpenScene::usable() const {
  if (process_ == ::getpid()) return {};
  return wrong_call(
      fmt::format("process {} opened this scene and process {} asks it: after fork() open the scene again",
                  process_, ::getpid()));
}

OpenScene::Turn OpenScene::take_engine() {
  std::unique_lock lock(mutex_);
  freed_.wait(lock, [&] { return !engine_taken_; });
  engine_taken_ = true;
  return turn(hosted_->backend.get());
}

OpenScene::Turn OpenScene::take_any() {
  std::unique_lock lock(mutex_);
  while (engine_taken_) {
    if (CollisionBackend* const found = fellow(lock)) return turn(found);
    if (engine_taken_) freed_.wait(lock);
  }
  engine_taken_ = true;
  return turn(hosted_->backend.get());
}

OpenScene::Turn OpenScene::take_fellow() {
  std::unique_lock lock(mutex_);
  return turn(fellow(lock));
}

/// A fellow that is free, or that can be made: the engine and its fellows are as many as processors. Null:
/// neither.
CollisionBackend* OpenScene::fellow(std::unique_lock<std::mutex>& lock) {
  if (!free_.empty()) {
    CollisionBackend* const found = free_.back();
    free_.pop_back();
    return found;
  }
  if (!another_ || fellows_.size() + 1 >= processors()) return nullptr;
  // Its place first: others may make theirs meanwhile, and giving back must not allocate.
  fellows_.emplace_back();
  free_.reserve(fellows_.size());
  const std::size_t place = fellows_.size() - 1;
  const SharedBackend::Another make = another_;
  lock.unlock();
  std::unique_ptr<CollisionBackend> made;
  try {
    made = make();
  } catch (const std::bad_alloc&) {  // those that can't be had are done without
  }
  lock.lock();
  if (!made) another_ = {};
  fellows_[place] = std::move(made);
  return fellows_[place].get();
}

void OpenScene::give(const CollisionBackend& asked) noexcept {
  {
    const std::lock_guard lock(mutex_);
    if (&asked == hosted_->backend.get())
      engine_taken_ = false;
    else
      free_.push_back(const_cast<CollisionBackend*>(&asked));  // has room
  }
  freed_.notify_all();
}

Result<void> OpenScene::ask(const Ask& asking) {
  if (auto mine = usable(); !mine) return mine;
  const Turn turn = take_engine();
  return asking(*turn);
}

Result<void> OpenScene::ask_any(const Ask& asking) {
  if (auto mine = usable(); !mine) return mine;
  {
    const Turn turn = take_any();
    const Result<void> done = asking(*turn);
    if (done || turn.get() == hosted_->backend.get()) return done;
  }
  return ask(asking);
}

Result<void> OpenScene::ask_side_by_side(std::size_t count, const BackendWork& work,
                                         const std::function<Result<void>(std::size_t done)>& look) {
  constexpr std::size_t kWorthAThread = 32;  // pieces (chosen: some milliseconds)
  if (auto mine = usable(); !mine) return mine;
  const Turn own = take_any();
  const std::size_t most = std::min<std::size_t>(processors(), count / kWorthAThread);
  std::vector<Turn> others;
  std::vector<CollisionBackend*> asked;
  while (others.size() + 1 < most) {
    Turn other = take_fellow();
    if (!other) break;
    asked.push_back(other.get());
    others.push_back(std::move(other));
  }
  Result<void> looked;
  const auto done = side_by_side(*own, asked, count, work, [&](std::size_t begun) {
    looked = look(begun);
    return static_cast<bool>(looked);
  });
  if (!done) return done.error();
  return looked;
}

Result<Pose> pose_at(const double* poses, std::size_t number) {
  std::array<double, 7> values{};
  std::copy_n(poses + 7 * number, 7, values.begin());
  Result<Pose> pose = pose_of(values);
  if (!pose) return bad_value(fmt::format("pose {} {}", number, pose.error().sentence));
  return pose;
}

std::uint8_t engine_code(std::string_view name) {
  return name == "gpu"   ? PALPATE_ENGINE_GPU
         : name == "cpu" ? PALPATE_ENGINE_CPU
         : name == "ref" ? PALPATE_ENGINE_REF
                         : PALPATE_ENGINE_NONE;
}

}  // namespace palpate::library

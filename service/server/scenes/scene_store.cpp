#include "service/server/scenes/scene_store.h"

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>
#include <system_error>

#include "model/bytes_of.h"
#include "service/loop/thread_share.h"
#include "service/server/http/json_input.h"
#include "service/server/http/safe_path.h"

namespace palpate {
namespace {

using nlohmann::ordered_json;
namespace fs = std::filesystem;
using Clock = std::chrono::steady_clock;

constexpr auto kProgressEvery = std::chrono::milliseconds(100);  ///< chosen: what a bar can show

std::uint64_t bytes_kept(const LatticeMesh& mesh) {
  return bytes_of(mesh.vertices) + bytes_of(mesh.triangles) + bytes_of(mesh.flags) +
         bytes_of(mesh.unit_normal_q30) + bytes_of(mesh.sample_weight_q30) + bytes_of(mesh.sample_axis) +
         bytes_of(mesh.neighbour_begin) + bytes_of(mesh.neighbours) + bytes_of(mesh.patch) +
         bytes_of(mesh.field_weight_q30) + bytes_of(mesh.extra_samples) + bytes_of(mesh.levels_of) +
         bytes_of(mesh.side_levels) + bytes_of(mesh.grid_samples);
}

/// What a prepared scene keeps: back end and integers.
std::uint64_t bytes_kept(const HostedScene& scene) {
  const LoadedScene& loaded = scene.loaded;
  return scene.backend->memory_bytes() + bytes_kept(loaded.geometry.mockup) +
         bytes_kept(loaded.geometry.tool);
}

ordered_json json_of(const Vec3& v) { return {v.x, v.y, v.z}; }

ordered_json json_of(const Pose& pose) {
  const Quat& q = pose.rotation;
  return {pose.position.x, pose.position.y, pose.position.z, q.x, q.y, q.z, q.w};
}

const char* name_of(SceneState state) {
  switch (state) {
    case SceneState::kQueued:
      return "queued";
    case SceneState::kPreparing:
      return "preparing";
    case SceneState::kReady:
      return "ready";
    case SceneState::kFailed:
      return "failed";
    case SceneState::kEvicted:
      return "evicted";
  }
  return "";
}

constexpr std::array kFacts = {"profile",      "stiffness",   "static_triangles", "tool_triangles",
                               "memory_bytes", "backend",     "device",           "voxel_size",
                               "bounds",       "tool_radius", "tool_gc",          "start",
                               "stages",       "driver",      "ignores_initial"};

/// What is known of a scene once it has been prepared.
ordered_json facts_of(const HostedScene& prepared, std::uint64_t bytes) {
  const LoadedScene& loaded = prepared.loaded;
  const SceneGeometry& geometry = loaded.geometry;
  const auto metres = [&](const Int3& p) {
    return json_of(geometry.lattice.origin_m + geometry.lattice.step_m * Vec3(p));
  };
  return {{"profile", loaded.scene.response.profile == Profile::kPaper ? "paper" : "refined"},
          {"stiffness", loaded.scene.response.stiffness_n_per_m},
          {"static_triangles", geometry.mockup.triangles.size()},
          {"tool_triangles", geometry.tool.triangles.size()},
          {"memory_bytes", bytes},
          {"backend", prepared.backend->name()},
          {"device", prepared.backend->device()},
          {"voxel_size", geometry.lattice.step_m * geometry.mockup_grid.size},
          {"bounds", {{"min", metres(geometry.mockup.box_min)}, {"max", metres(geometry.mockup.box_max)}}},
          {"tool_radius", geometry.lattice.step_m * geometry.tool_radius},
          {"tool_gc", json_of(geometry.tool_gc_m)},
          {"start", json_of(loaded.scene.start)},
          {"stages", loaded.scene.stage_names},
          {"driver", loaded.scene.device.driver},
          {"ignores_initial", loaded.scene.start_contacts == StartContacts::kIgnoreInitial}};
}

void remove_folder(const fs::path& folder) {
  std::error_code ignored;
  fs::remove_all(folder, ignored);
}

}  // namespace

struct SceneStore::Entry {
  SceneContent content;
  SceneState state = SceneState::kQueued;
  std::uint64_t version = 0;
  std::string step;
  double progress = 0;
  std::optional<Problem> error;
  ordered_json facts;
  std::vector<std::string> warnings;
  std::shared_ptr<HostedScene> prepared;
  std::uint64_t bytes = 0;
  std::uint64_t engine_bytes = 0;  ///< of these, its engine's before anybody asked it
  std::shared_ptr<SceneLease::Count> count = std::make_shared<SceneLease::Count>();
  bool removed = false;
};

SceneStore::SceneStore(const Parts& parts, std::string backend, const ServerLimits& limits, Metrics& metrics,
                       Log& log)
    : parts_(parts),
      backend_(std::move(backend)),
      limits_(limits),
      metrics_(metrics),
      log_(log),
      thread_([this] { prepare_loop(); }) {}

SceneStore::~SceneStore() {
  {
    const std::lock_guard lock(mutex_);
    stop_ = true;
  }
  cancel();
  work_.notify_all();
  thread_.join();
}

std::shared_ptr<SceneStore::Entry> SceneStore::find_locked(const std::string& id) const {
  const auto found = std::find_if(entries_.begin(), entries_.end(),
                                  [&](const auto& entry) { return entry->content.id == id; });
  return found == entries_.end() ? nullptr : *found;
}

SceneStore::View SceneStore::view_of(const Entry& entry) const {
  ordered_json json = {{"id", entry.content.id},
                       {"name", entry.content.name},
                       {"state", name_of(entry.state)},
                       {"step", entry.step},
                       {"progress", std::round(entry.progress * 1000) / 1000}};
  json["error"] = entry.error ? ordered_json::parse(entry.error->json()) : ordered_json();
  for (const char* fact : kFacts)
    json[fact] = entry.facts.contains(fact) ? entry.facts[fact] : ordered_json();
  json["warnings"] = entry.warnings;
  json["users"] = entry.count->loops.load();
  return {entry.state, entry.version, dump(json)};
}

void SceneStore::changed(Entry& entry) { ++entry.version; }

void SceneStore::notify() {
  const std::lock_guard lock(listeners_->mutex);
  for (const auto& call : listeners_->calls) call();
}

std::shared_ptr<void> SceneStore::listen(std::function<void()> changed) {
  const std::lock_guard lock(listeners_->mutex);
  const auto place = listeners_->calls.insert(listeners_->calls.end(), std::move(changed));
  return {nullptr, [listeners = listeners_, place](void*) {
            const std::lock_guard inner(listeners->mutex);
            listeners->calls.erase(place);
          }};
}

std::optional<Problem> SceneStore::make_room_locked(std::uint64_t disk_bytes,
                                                    std::vector<fs::path>& garbage) {
  const auto used = [&] {
    std::uint64_t sum = disk_bytes;
    for (const auto& entry : entries_) sum += entry->content.disk_bytes;
    return sum;
  };
  for (auto it = entries_.begin();
       (entries_.size() >= limits_.scenes || used() > limits_.disk_bytes) && it != entries_.end();) {
    Entry& entry = **it;
    const bool idle = entry.state == SceneState::kFailed || entry.state == SceneState::kEvicted;
    if (!idle || entry.count->all > 0 ||
        (entries_.size() < limits_.scenes && entry.content.disk_bytes == 0)) {
      ++it;
      continue;
    }
    entry.removed = true;
    changed(entry);
    if (entry.content.uploaded) garbage.push_back(entry.content.folder);
    it = entries_.erase(it);
  }
  if (entries_.size() >= limits_.scenes)
    return Problem{503, "busy", "there are " + std::to_string(limits_.scenes) + " scenes already; delete one",
                   ""};
  if (used() > limits_.disk_bytes)
    return Problem{507, "storage",
                   "uploads may take " + std::to_string(limits_.disk_bytes >> 20) +
                       " MiB of disk together; delete a scene",
                   ""};
  return std::nullopt;
}

std::variant<SceneStore::View, Problem> SceneStore::add(SceneContent content) {
  std::vector<fs::path> garbage;
  std::variant<View, Problem> answer;
  {
    const std::lock_guard lock(mutex_);
    std::shared_ptr<Entry> entry = find_locked(content.id);
    if (entry) {
      if (content.uploaded && content.folder != entry->content.folder) garbage.push_back(content.folder);
    } else if (auto problem = make_room_locked(content.disk_bytes, garbage)) {
      if (content.uploaded) garbage.push_back(content.folder);
      answer = *problem;
    } else {
      entry = std::make_shared<Entry>();
      entry->content = std::move(content);
      entry->state = SceneState::kFailed;  // queued below
      entries_.push_back(entry);
    }
    if (entry) {
      if (entry->state == SceneState::kFailed || entry->state == SceneState::kEvicted) {
        entry->state = SceneState::kQueued;
        entry->error.reset();
        entry->progress = 0;
        queue_.push_back(entry);
        changed(*entry);
      }
      answer = view_of(*entry);
    }
  }
  for (const fs::path& folder : garbage) remove_folder(folder);
  work_.notify_all();
  notify();
  return answer;
}

std::optional<SceneStore::View> SceneStore::view(const std::string& id) const {
  const std::lock_guard lock(mutex_);
  const auto entry = find_locked(id);
  if (!entry) return std::nullopt;
  return view_of(*entry);
}

std::string SceneStore::name(const std::string& id) const {
  const std::lock_guard lock(mutex_);
  const auto entry = find_locked(id);
  return entry ? entry->content.name : id;
}

std::vector<SceneStore::View> SceneStore::all() const {
  const std::lock_guard lock(mutex_);
  std::vector<View> views;
  for (const auto& entry : entries_) views.push_back(view_of(*entry));
  return views;
}

std::optional<Problem> SceneStore::remove(const std::string& id) {
  std::shared_ptr<Entry> entry;
  {
    const std::lock_guard lock(mutex_);
    entry = find_locked(id);
    if (!entry) return Problem{404, "not-found", "there is no scene " + shown_text(id), "id"};
    if (entry->count->loops > 0)
      return Problem{409, "conflict", "a session or a haptic loop uses the scene", "id"};
    entry->removed = true;  // a preparation under way sees it and ends
    changed(*entry);
    entries_.remove(entry);
    queue_.remove(entry);
  }
  if (entry->content.uploaded && entry->state != SceneState::kPreparing) remove_folder(entry->content.folder);
  log_.info("scene_deleted", {{"scene", id}});
  notify();
  return std::nullopt;
}

std::variant<SceneUse, Problem> SceneStore::use(const std::string& id, bool loop) {
  std::optional<Problem> problem;
  {
    const std::lock_guard lock(mutex_);
    const auto entry = find_locked(id);
    if (!entry) return Problem{404, "not-found", "there is no scene " + shown_text(id), "id"};
    entries_.remove(entry);
    entries_.push_back(entry);
    switch (entry->state) {
      case SceneState::kReady:
        return std::make_shared<SceneLease>(entry->prepared, entry->count, loop);
      case SceneState::kFailed:
        return Problem{409, "conflict", "the scene could not be prepared: " + entry->error->detail, "id"};
      case SceneState::kEvicted:
        entry->state = SceneState::kQueued;
        entry->progress = 0;
        queue_.push_back(entry);
        changed(*entry);
        problem = Problem{503, "busy", "the scene was evicted and is being prepared again", "id"};
        break;
      default:
        problem = Problem{503, "busy", "the scene is not ready yet", "id"};
    }
  }
  work_.notify_all();
  notify();
  return *problem;
}

std::vector<Metrics::Gauge> SceneStore::gauges() const {
  const std::lock_guard lock(mutex_);
  double ready = 0, bytes = 0;
  for (const auto& entry : entries_)
    if (entry->state == SceneState::kReady) ++ready, bytes += static_cast<double>(entry->bytes);
  return {{"palpate_scenes", "Scenes known.", static_cast<double>(entries_.size())},
          {"palpate_scenes_ready", "Scenes prepared and in memory.", ready},
          {"palpate_scene_memory_bytes", "Memory of the prepared scenes.", bytes},
          {"palpate_scene_memory_budget_bytes", "Memory that prepared scenes may take.",
           static_cast<double>(limits_.memory_bytes)},
          {"palpate_scene_queue", "Scenes waiting to be prepared.", static_cast<double>(queue_.size())}};
}

void SceneStore::prepare_loop() {
  for (;;) {
    std::shared_ptr<Entry> entry;
    {
      std::unique_lock lock(mutex_);
      work_.wait(lock, [&] { return stop_ || !queue_.empty(); });
      if (stop_) return;
      entry = queue_.front();
      queue_.pop_front();
      entry->state = SceneState::kPreparing;
      changed(*entry);
    }
    notify();
    // On a thread of its own: it gives way once the back end is made, and no thread can take that back
    // without rights.
    try {
      std::thread([&] { prepare_one(entry); }).join();
    } catch (const std::system_error&) {  // there can be no more threads
      prepare_one(entry);
    }
    notify();
  }
}

void SceneStore::prepare_one(const std::shared_ptr<Entry>& entry) {
  SceneOptions options;
  options.scene = entry->content.file.string();
  options.backend = entry->content.engine.empty() ? backend_ : entry->content.engine;
  options.profile = entry->content.profile;
  auto last = Clock::now() - kProgressEvery;
  std::vector<std::string> warnings;
  PrepareWatch watch;
  watch.folder = entry->content.folder.string();
  watch.cached = !entry->content.uploaded;
  watch.note = [&](const std::string& sentence) {
    log_.info("scene_note", {{"scene", entry->content.id}, {"note", sentence}});
  };
  // A driver's threads begin at their maker's share, and answer for loops later; the rest of the preparation
  // gives way: whoever feels a force comes before a scene that is not there yet.
  std::optional<MakesForHand> making(std::in_place);
  watch.step = [&](const char* step) {
    if (making) {  // the first step comes after the back end
      making.reset();
      set_nice(kNicePreparation);
    }
    {
      const std::lock_guard lock(mutex_);
      entry->step = step;
      entry->progress = 0;
      changed(*entry);
    }
    notify();
  };
  watch.progress = [&](const char* /*what*/, double done) {
    const auto now = Clock::now();
    bool go_on = true, tell = false;
    {
      const std::lock_guard lock(mutex_);
      go_on = !stopping_ && !entry->removed;
      if (go_on && now - last >= kProgressEvery) {
        last = now;
        tell = true;
        entry->progress = std::clamp(done, 0.0, 1.0);
        changed(*entry);
      }
    }
    if (tell) notify();
    return go_on;
  };
  bool too_many = false;
  watch.admit = [&](const LoadedScene& loaded) -> Result<void> {
    const std::uint64_t triangles =
        loaded.geometry.mockup.triangles.size() + loaded.geometry.tool.triangles.size();
    too_many = triangles > limits_.triangles;
    if (too_many)
      return bad_value("the scene has " + std::to_string(triangles) + " triangles, and the limit is " +
                       std::to_string(limits_.triangles));
    return {};
  };

  std::optional<Problem> problem;
  std::shared_ptr<HostedScene> prepared;
  try {
    auto made = prepare_scene(options, Purpose::kQuery, parts_, watch);
    if (made)
      if (auto finished = (*made)->backend->finish_preparing(); !finished)
        made = finished.error();  // sessions ask it, too
    if (made)
      prepared = std::move(*made);
    else
      problem = problem_of(made.error());
    if (too_many) problem = Problem{413, "too-large", made.error().sentence, "scene"};
  } catch (const std::bad_alloc&) {
    problem = Problem{507, "storage", "there is not enough memory for this scene", ""};
  } catch (const std::exception& error) {
    problem = Problem{500, "internal", std::string("preparing the scene failed: ") + error.what(), ""};
  }
  if (problem) {
    problem->detail = without_folder(std::move(problem->detail), entry->content.folder);
    log_.warn("scene_failed", {{"scene", entry->content.id}, {"detail", problem->detail}});
    bool removed = false;
    {
      const std::lock_guard lock(mutex_);
      entry->state = SceneState::kFailed;
      entry->error = std::move(problem);
      changed(*entry);
      removed = entry->removed;
    }
    if (removed && entry->content.uploaded) remove_folder(entry->content.folder);
    return;
  }
  if (entry->content.ignore_initial) prepared->loaded.scene.start_contacts = StartContacts::kIgnoreInitial;
  finish(entry, prepared, bytes_kept(*prepared));
}

/// Whether `bytes` more fit into the budget, after evicting scenes out of use.
bool SceneStore::make_memory_locked(std::uint64_t bytes, std::vector<std::shared_ptr<HostedScene>>& evicted) {
  std::uint64_t sum = bytes;
  for (const auto& other : entries_)
    if (other->prepared) sum += other->bytes;
  if (bytes <= limits_.memory_bytes)
    for (const auto& other : entries_) {
      if (sum <= limits_.memory_bytes) break;
      if (!other->prepared || other->count->all > 0) continue;
      sum -= other->bytes;
      evicted.push_back(std::move(other->prepared));
      other->prepared.reset();
      other->state = SceneState::kEvicted;
      changed(*other);
      ++metrics_.scenes_evicted;
      log_.info("scene_evicted", {{"scene", other->content.id}, {"memory_bytes", other->bytes}});
    }
  return sum <= limits_.memory_bytes;
}

Aside SceneStore::aside(const SceneLease& lease) {
  HostedScene& scene = *lease;
  Aside aside{std::unique_lock(scene.aside_mutex), scene.aside.get()};
  if (aside.backend || scene.aside_failed) return aside;
  std::uint64_t bytes = 0;  // as the first one's, which others may be asking now
  std::shared_ptr<Entry> entry;
  std::vector<std::shared_ptr<HostedScene>> evicted;  // given back when nobody is locked out
  {
    const std::lock_guard lock(mutex_);
    for (const auto& known : entries_)
      if (known->prepared.get() == &scene) entry = known;
    if (!entry) return aside;
    bytes = entry->engine_bytes;
    if (!make_memory_locked(bytes, evicted)) return aside;
    entry->bytes += bytes;  // its place is kept while it is made
  }
  evicted.clear();
  const auto note = [&](const std::string& sentence) {
    log_.info("scene_note", {{"scene", entry->content.id}, {"note", sentence}});
  };
  std::string engine = entry->content.engine.empty() ? backend_ : entry->content.engine;
  if (scene.backend->name() == "cpu") engine = "cpu";  // by measurement, where `auto` was asked for
  auto made =
      choose_backend(engine, scene.loaded.scene.response.profile, parts_, note, !entry->content.uploaded);
  Result<void> prepared = made ? Result<void>() : made.error();
  if (made)
    prepared = (*made)->prepare(scene.loaded.geometry, scene.plan.plan,
                                [this](const char*, double) { return !stopping_; });
  if (prepared) prepared = (*made)->finish_preparing();
  if (prepared) {
    scene.aside = std::move(*made);
    aside.backend = scene.aside.get();
    log_.info("scene_doubled", {{"scene", entry->content.id}, {"memory_bytes", bytes}});
    return aside;
  }
  scene.aside_failed = true;
  note("no second back end, so batches and loops take turns: " + prepared.error().sentence);
  const std::lock_guard lock(mutex_);
  entry->bytes -= bytes;
  return aside;
}

void SceneStore::finish(const std::shared_ptr<Entry>& entry, std::shared_ptr<HostedScene> prepared,
                        std::uint64_t bytes) {
  std::vector<std::shared_ptr<HostedScene>> evicted;  // given back when nobody is locked out
  bool removed = false;
  {
    const std::lock_guard lock(mutex_);
    if (!make_memory_locked(bytes, evicted)) {
      const bool alone = bytes > limits_.memory_bytes;
      entry->state = SceneState::kFailed;
      entry->error =
          Problem{alone ? 413u : 503u, alone ? "too-large" : "busy",
                  "the scene takes " + std::to_string(bytes >> 20) + " MiB, and " +
                      (alone ? "scenes may take " + std::to_string(limits_.memory_bytes >> 20) + " MiB"
                             : "those in use leave no room for it"),
                  ""};
    } else {
      entry->state = SceneState::kReady;
      entry->step.clear();
      entry->progress = 1;
      entry->bytes = bytes;
      entry->engine_bytes = prepared->backend->memory_bytes();
      entry->facts = facts_of(*prepared, bytes);
      entry->warnings = prepared->loaded.scene.warnings;
      const std::string &asked = entry->content.engine.empty() ? backend_ : entry->content.engine,
                        answers = prepared->backend->name();
      if (!asked.empty() && asked != "auto" && asked != answers)
        entry->warnings.push_back("the engine " + asked + " can't take the scene: " + answers + " answers");
      entry->prepared = std::move(prepared);
      ++metrics_.scenes_prepared;
    }
    removed = entry->removed;
    changed(*entry);
    entries_.remove(entry);
    if (!removed) entries_.push_back(entry);
    log_.info("scene_prepared",
              {{"scene", entry->content.id}, {"state", name_of(entry->state)}, {"memory_bytes", bytes}});
  }
  if (removed && entry->content.uploaded) remove_folder(entry->content.folder);
}

}  // namespace palpate

#include "service/cli/scene_host.h"

#include <fmt/format.h>

#include <chrono>
#include <utility>

#include "model/scene/scene_file.h"
#include "service/cli/numbers.h"
#include "service/engine_times.h"
#include "service/loop/steady_backend.h"
#include "service/queries/first_contact.h"

namespace palpate {
namespace {

using Clock = std::chrono::steady_clock;

constexpr std::uint64_t kWorthTelling = std::uint64_t{256} << 20;  // of memory (chosen)

double seconds_since(Clock::time_point start) {
  return std::chrono::duration<double>(Clock::now() - start).count();
}

PlanFacts facts_of(const LoadedScene& loaded, Purpose purpose, bool full) {
  PlanFacts facts = purpose == Purpose::kQuery
                        ? query_facts(loaded.scene, loaded.geometry)
                        : session_facts(loaded.scene, loaded.geometry, purpose == Purpose::kRecording);
  facts.full = full;
  return facts;
}

/// What each stage keeps on the back end; one that doesn't tell stages apart keeps all for finding pairs.
void add_memory(const CollisionBackend& backend, std::vector<PlanStage>& stages) {
  std::vector<StageMemory> memory = backend.memory_by_stage();
  if (memory.empty()) memory.push_back({"pairs", backend.memory_bytes()});
  for (const StageMemory& line : memory)
    for (PlanStage& stage : stages)
      if (stage.stage == line.stage) stage.memory_bytes += line.bytes;
}

std::string prepared_text(const HostedScene& prepared) {
  const SceneGeometry& geometry = prepared.loaded.geometry;
  const double step_mm = 1000 * geometry.lattice.step_m;
  return fmt::format(
      "mock-up {} triangles, tool {}, voxels of {:.3g} mm, samples {:.3g} mm apart, {} on {}; "
      "{} in {:.2f} s, prepared in {:.2f} s",
      count_text(geometry.mockup.triangles.size()), count_text(geometry.tool.triangles.size()),
      step_mm * geometry.mockup_grid.size, step_mm * geometry.sample_spacing,
      bytes_text(prepared.backend->memory_bytes()), prepared.backend->device(),
      prepared.loaded.from_cache ? "known from before, read" : "read", prepared.load_s, prepared.prepare_s);
}

/// Where a GPU answers, whether native code does so sooner here: both are asked at a few poses, and `cpu`
/// takes over where it is the quicker by more than kAlike. Not for a loop that is to go over to `paper`,
/// which `cpu` doesn't know. Error: interrupted.
Result<void> take_quicker(const SceneOptions& options, const Parts& parts, const PrepareWatch& watch,
                          HostedScene& prepared) {
  const LoadedScene& loaded = prepared.loaded;
  if (prepared.backend->name() != "gpu" || loaded.scene.response.profile != Profile::kRefined ||
      options.second_backend || !parts.has_gpu())
    return {};
  bool stopped = false;
  const Progress progress = [&](const char* what, double done) {
    return !watch.progress || !(stopped = stopped || !watch.progress(what, done));
  };
  watch.step("measuring the engines");
  auto native = choose_backend("cpu", Profile::kRefined, parts, watch.note, watch.cached);
  Result<void> ready = native ? (*native)->prepare(loaded.geometry, prepared.plan.plan, progress)
                              : Result<void>(native.error());
  if (stopped) return Error{ErrorCode::kInternal, "interrupted"};
  if (ready && (*native)->name() != "cpu") {  // but its spare
    for (const std::string& note : (*native)->take_notes()) watch.note(note);
    ready = Error{ErrorCode::kInternal, "that engine can't prepare the scene"};
  }
  if (ready) ready = prepared.backend->finish_preparing();
  std::vector<EngineTime> times;
  for (CollisionBackend* backend : {prepared.backend.get(), ready ? native->get() : nullptr}) {
    if (!ready) break;
    if (auto timed = time_engine(loaded, *backend); timed)
      times.push_back(std::move(*timed));
    else
      ready = timed.error();
  }
  if (!ready) {
    watch.note("the engine gpu answers; it was not measured beside cpu: " + ready.error().sentence);
    return {};
  }
  const bool quicker = times[0].frame_us > kAlike * times[1].frame_us;
  if (quicker) prepared.backend = std::move(*native);
  watch.note(fmt::format("the engine {} answers: a frame near the start, {}", quicker ? "cpu" : "gpu",
                         engines_text(times)));
  return {};
}

}  // namespace

Result<std::unique_ptr<CollisionBackend>> choose_backend(
    const std::string& name, std::optional<Profile> profile, const Parts& parts,
    const std::function<void(const std::string& sentence)>& note, bool cached) {
  using Backend = std::unique_ptr<CollisionBackend>;
  const auto steady = [](Backend first, SteadyBackend::Make spare) -> Backend {
    return std::make_unique<SteadyBackend>(std::move(first), std::move(spare));
  };
  // What the native engine can't do, the profile `paper` above all, the reference does.
  const auto native = [steady, cached, make_cpu = parts.make_cpu, make_ref = parts.make_ref] {
    return steady(make_cpu(cached), make_ref);
  };
  if (name == "ref") return parts.make_ref();
  if (name == "cpu") return native();
  if (name == "gpu") {  // who asks for the device gets it or a refusal
    auto gpu = parts.make_gpu(cached);
    if (!gpu) return Error{gpu.error().code, "--backend gpu: " + gpu.error().sentence};
    return steady(std::move(*gpu), nullptr);
  }
  if (parts.has_gpu()) {
    auto gpu = parts.make_gpu(cached);
    if (gpu) return steady(std::move(*gpu), native);
    note(gpu.error().sentence + ": the engine cpu answers");
    return native();
  }
  // On the processor the native engine is the quicker one by far; `paper` it leaves to the shaders, where
  // there is a driver that runs them here.
  if (profile == Profile::kRefined) {
    note("no GPU can be used: the engine cpu answers");
    return native();
  }
  auto gpu = parts.make_gpu(cached);
  if (!gpu) {
    note(gpu.error().sentence + (profile ? ": the engine ref answers" : ": the engines cpu and ref answer"));
    return profile ? parts.make_ref() : native();
  }
  note("no GPU can be used: the engine gpu answers in paper, on " + (*gpu)->device() +
       (profile ? "" : ", and the engine cpu in refined"));
  if (profile) return steady(std::move(*gpu), parts.make_ref);
  const auto shaders = std::make_shared<Backend>(std::move(*gpu));  // taken once
  return steady(parts.make_cpu(cached), [steady, shaders, make_ref = parts.make_ref] {
    return steady(std::move(*shaders), make_ref);
  });
}

Result<std::unique_ptr<CollisionBackend>> choose_backend(const std::string& name,
                                                         std::optional<Profile> profile, const Parts& parts,
                                                         Console& console) {
  return choose_backend(name, profile, parts,
                        [&console](const std::string& sentence) { console.note(sentence); });
}

Result<std::unique_ptr<HostedScene>> prepare_scene(const SceneOptions& options, Purpose purpose,
                                                   const Parts& parts, const PrepareWatch& watch) {
  Result<Scene> scene = read_scene(options.scene, options.profile);
  if (!scene) return scene.error();
  return prepare_scene(std::move(*scene), options, purpose, parts, watch);
}

Result<std::unique_ptr<HostedScene>> prepare_scene(Scene scene, const SceneOptions& options, Purpose purpose,
                                                   const Parts& parts, const PrepareWatch& watch) {
  auto prepared = std::make_unique<HostedScene>();
  if (options.unit_m) {
    const auto take_unit = [&](MeshSource& source) {
      if (!source.file.empty() && !source.scale_stated && !states_unit(source.file))
        source.scale = *options.unit_m;
    };
    for (StaticBody& body : scene.statics) take_unit(body.source);
    take_unit(scene.tool.source);
  }

  // The back end comes before the meshes: their import may start threads.
  const std::optional<Profile> profile =
      options.second_backend ? std::nullopt : std::optional(scene.response.profile);
  Result<std::unique_ptr<CollisionBackend>> backend =
      choose_backend(options.backend, profile, parts, watch.note, watch.cached);
  if (!backend) return backend.error();
  prepared->backend = std::move(*backend);
  if (options.second_backend) {
    auto second = choose_backend(
        options.backend, profile, parts, [](const std::string&) {}, watch.cached);
    if (!second) return second.error();
    prepared->second = std::move(*second);
  }

  watch.step("reading the meshes");
  const auto load_start = Clock::now();
  Result<LoadedScene> loaded = load_scene(std::move(scene), watch.progress, options.import,
                                          watch.cached ? parts.cache.get() : nullptr, watch.folder);
  if (!loaded) return loaded.error();
  prepared->loaded = std::move(*loaded);
  if (options.all_samples) prepared->loaded.geometry.contact_samples = 0;
  prepared->load_s = seconds_since(load_start);
  if (watch.admit)
    if (auto admitted = watch.admit(prepared->loaded); !admitted) return admitted.error();
  for (const std::string& warning : prepared->loaded.scene.warnings) watch.note(warning);

  watch.step("preparing the scene");
  const auto prepare_start = Clock::now();
  PlanFacts facts = facts_of(prepared->loaded, purpose, options.full_plan);
  prepared->plan = decide_plan(facts);
  // Only meshes that name no other file are kept, so that `folder` has nothing to say about them.
  if (const std::uint64_t bytes =
          prepared->backend->preparation_bytes(prepared->loaded.geometry, prepared->plan.plan);
      bytes >= kWorthTelling)
    watch.note(fmt::format("preparing takes up to {} on {}", bytes_text(bytes), prepared->backend->device()));
  if (auto done = prepared->backend->prepare(prepared->loaded.geometry, prepared->plan.plan, watch.progress);
      !done)
    return done.error();
  for (const std::string& note : prepared->backend->take_notes()) watch.note(note);
  if (parts.cache)
    for (const std::string& note : parts.cache->take_notes()) watch.note(note);
  // Whether there are V_int voxels is known only now.
  facts.internal_voxels = prepared->backend->has_internal_voxels();
  prepared->plan = decide_plan(facts);
  if (options.backend.empty() || options.backend == "auto")
    if (auto done = take_quicker(options, parts, watch, *prepared); !done) return done.error();
  add_memory(*prepared->backend, prepared->plan.stages);
  prepared->prepare_s = seconds_since(prepare_start);
  watch.note(prepared_text(*prepared));
  return prepared;
}

Result<std::unique_ptr<HostedScene>> prepare_for_verdicts(SceneOptions options, double tolerance_m,
                                                          const Parts& parts, Console& console) {
  // A verdict counts containment, for which `paper` has no set.
  if (const auto stated = read_scene(options.scene, options.profile);
      stated && stated->response.profile == Profile::kPaper)
    console.note("the profile is paper; whether and how deep the tool touches is asked as in refined");
  options.profile = Profile::kRefined;
  options.all_samples = tolerance_m > 0;
  auto prepared = prepare_scene(options, Purpose::kQuery, parts, console);
  if (!prepared || tolerance_m == 0) return prepared;
  const SceneGeometry& geometry = (*prepared)->loaded.geometry;
  if (TouchRule::of(geometry, tolerance_m).tolerance == 0)
    return bad_value(fmt::format(
        "--tolerance {:g} is less than a step of the scene's lattice, {:.3g} m; say 0 or more than that",
        tolerance_m, geometry.lattice.step_m));
  return prepared;
}

Result<std::unique_ptr<HostedScene>> prepare_scene(const SceneOptions& options, Purpose purpose,
                                                   const Parts& parts, Console& console) {
  return prepare_scene(
      options, purpose, parts,
      PrepareWatch{
          .note = [&console](const std::string& sentence) { console.note(sentence); },
          .step = [&console](const char* step) { console.step(step); },
          .progress = [&console](const char* what, double done) { return console.progress(what, done); },
          .admit = {},
          .cached = true,
          .folder = {}});
}

}  // namespace palpate

#include "service/server/queries/path_route.h"

#include <chrono>
#include <memory>
#include <optional>
#include <utility>

#include "service/queries/path_check.h"
#include "service/report/path_page.h"
#include "service/server/http/json_input.h"
#include "service/server/queries/polite_backend.h"
#include "service/server/queries/pose_body.h"

namespace palpate {
namespace {

constexpr auto kLongest = std::chrono::minutes(2);  ///< chosen: a browser that waits longer has gone

/// Whatever happens meanwhile, the next may come.
struct Freed {
  std::atomic<bool>& busy;
  ~Freed() { busy = false; }
};

HttpResponse examined(SceneStore& store, SceneLease& scene, const std::vector<Pose>& poses,
                      const std::string& name, const std::atomic<bool>& stopping,
                      const std::atomic<bool>& client_gone) {
  const LoadedScene& loaded = scene->loaded;
  if (loaded.scene.response.profile != Profile::kRefined)
    return Problem{409, "conflict",
                   "contact and depth along a path are those of the profile refined, and this scene is of "
                   "paper",
                   "id"};
  PoliteBackend backend(store, scene);
  const auto end = std::chrono::steady_clock::now() + kLongest;
  bool late = false;
  const auto report = check_path(loaded, backend, poses, TouchRule::of(loaded.geometry, 0), std::nullopt,
                                 [&](const char*, double) {
                                   late = std::chrono::steady_clock::now() > end;
                                   return !late && !stopping && !client_gone;
                                 });
  if (late)
    return Problem{503, "busy",
                   "the path takes more than two minutes to examine; `palpate path` has no such limit", ""};
  if (client_gone)  // for the log; nginx counts by this number, too
    return Problem{499, "client-gone", "the client closed the connection before its path was examined", ""};
  if (!report) return problem_of(report.error());
  HttpResponse response(200, path_page(loaded, *report, "The path asked about", name,
                                       backend.name() + " on " + backend.device()));
  response.type = "text/html; charset=utf-8";
  // It runs nothing, wherever it is shown.
  response.headers.emplace_back("Content-Security-Policy", "sandbox; default-src 'unsafe-inline' data:");
  return response;
}

}  // namespace

void add_path_route(Router& router, SceneStore& store, WorkerPool& workers, const ServerLimits& limits,
                    const std::atomic<bool>& stopping) {
  const auto busy = std::make_shared<std::atomic<bool>>(false);
  router.add({.method = "POST",
              .pattern = "v1/scenes/*/path",
              .body_limit = limits.poses_bytes,
              .handle = [&store, &workers, &limits, &stopping, busy](HttpRequest request, Reply reply) {
                workers.post([&store, &limits, &stopping, busy, request = std::move(request), reply] {
                  const std::string& id = request.segments[2];
                  const auto scene = store.use(id, false);
                  if (const auto* problem = std::get_if<Problem>(&scene)) return reply(*problem);
                  const auto poses = read_pose_body(request.content_type, request.body, limits);
                  if (const auto* problem = std::get_if<Problem>(&poses)) return reply(*problem);
                  if (busy->exchange(true))
                    return reply(Problem{503, "busy", "another path is being examined; ask again", ""});
                  HttpResponse answer = [&] {
                    const Freed freed{*busy};
                    return examined(store, *std::get<SceneUse>(scene), std::get<std::vector<Pose>>(poses),
                                    store.name(id), stopping, *request.client_gone);
                  }();
                  reply(std::move(answer));
                });
              }});
}

}  // namespace palpate

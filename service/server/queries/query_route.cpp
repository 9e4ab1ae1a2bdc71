#include "service/server/queries/query_route.h"

#include <charconv>
#include <optional>

#include "service/server/http/json_input.h"
#include "service/server/queries/pose_body.h"

namespace palpate {

void add_query_route(Router& router, SceneStore& store, BatchQueue& batches, WorkerPool& workers,
                     const ServerLimits& limits) {
  const auto ask = [&store, &batches, &limits](const HttpRequest& request, const Reply& reply) {
    const std::string sets = request.query_or("sets", "1");
    if (sets != "0" && sets != "1")
      return reply(bad_request("sets is '" + shown_text(sets) + "', allowed is 0 or 1", "sets"));
    const std::string names = request.query_or("names", "0");
    if (names != "0" && names != "1")
      return reply(bad_request("names is '" + shown_text(names) + "', allowed is 0 or 1", "names"));
    const std::string any = request.query_or("any", "0");
    if (any != "0" && any != "1")
      return reply(bad_request("any is '" + shown_text(any) + "', allowed is 0 or 1", "any"));
    const std::string clearance = request.query_or("clearance", "0");
    if (clearance != "0" && clearance != "1")
      return reply(
          bad_request("clearance is '" + shown_text(clearance) + "', allowed is 0 or 1", "clearance"));
    const std::string within = request.query_or("within", "");
    std::optional<double> within_m;
    if (request.query.contains("within")) {
      double value = 0;
      const auto [stop, error] = std::from_chars(within.data(), within.data() + within.size(), value);
      if (error != std::errc() || stop != within.data() + within.size() || !(value >= 0 && value <= 100))
        return reply(bad_request("within is '" + shown_text(within) + "', allowed is 0 to 100 m", "within"));
      within_m = value;
    }
    const bool how_far = clearance == "1" || within_m;
    if (any == "1" && how_far)
      return reply(bad_request(
          std::string("any and ") + (within_m ? "within" : "clearance") + " are two questions: ask one",
          within_m ? "within" : "clearance"));
    if (names == "1" && (any == "1" || how_far))
      return reply(bad_request(std::string("names is for whole answers, and ") +
                                   (any == "1" ? "any"
                                    : within_m ? "within"
                                               : "clearance") +
                                   " asks for none",
                               "names"));
    auto scene = store.use(request.segments[2], false);
    if (const auto* problem = std::get_if<Problem>(&scene)) return reply(*problem);
    auto poses = read_pose_body(request.content_type, request.body, limits);
    if (const auto* problem = std::get_if<Problem>(&poses)) return reply(*problem);
    batches.add(
        {.scene = std::get<SceneUse>(scene),
         .poses = std::move(std::get<std::vector<Pose>>(poses)),
         .sets = sets == "1",
         .names = names == "1",
         .any = any == "1",
         .clearance = how_far,
         .within_m = within_m,
         .binary = any == "0" && !how_far &&
                   prefers(request.accept, "application/vnd.palpate.wrenches", "application/x-ndjson")},
        reply);
  };
  router.add({.method = "POST",
              .pattern = "v1/scenes/*/query",
              .parameters = {"sets", "names", "any", "clearance", "within"},
              .body_limit = limits.poses_bytes,
              .handle = [&workers, ask](HttpRequest request, Reply reply) {
                // A short body is read at once: a lone pose then never waits behind a long one.
                if (request.body.size() <= 4096) return ask(request, reply);
                workers.post([ask, request = std::move(request), reply] { ask(request, reply); });
              }});
}

}  // namespace palpate

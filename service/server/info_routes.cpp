#include "service/server/info_routes.h"

#include <fmt/format.h>

#include <nlohmann/json.hpp>

#include "service/server/http/json_input.h"
#include "service/server/openapi.h"
#include "service/viewer/viewer_files.h"

namespace palpate {
namespace {

using nlohmann::ordered_json;

constexpr fmt::string_view kNoViewer =
    "<!doctype html><meta charset=utf-8><title>palpate</title><body style=\"font:16px "
    "sans-serif;max-width:40em;margin:3em auto\"><h1>palpate</h1>"
    "<p>The service is running, and its viewer is missing. {} Install node and npm, configure with "
    "<code>-DPALPATE_VIEWER=ON</code> and build again.</p>"
    "<p>All else is here: <a href=/openapi.json>/openapi.json</a>, <a href=/v1/scenes>/v1/scenes</a>, <a "
    "href=/metrics>/metrics</a>.</p>";

/// Pages of ours load nothing from elsewhere, and no other page frames them.
constexpr std::string_view kPolicy =
    "default-src 'self'; img-src 'self' data: blob:; style-src 'self' 'unsafe-inline'; worker-src 'self' "
    "blob:; connect-src 'self' ws: wss:; frame-ancestors 'none'";

HttpResponse text(std::string type, std::string body) {
  HttpResponse response(200, std::move(body));
  response.type = std::move(type);
  return response;
}

HttpResponse page(std::string_view type, std::string_view content) {
  HttpResponse response = text(std::string(type), std::string(content));
  response.headers.emplace_back("Content-Security-Policy", std::string(kPolicy));
  response.headers.emplace_back("Referrer-Policy", "no-referrer");
  return response;
}

std::string info_json(const InfoSources& sources) {
  const ServerLimits& limits = sources.limits;
  return dump({{"version", PALPATE_VERSION},
               {"backend", sources.backend.empty() ? "auto" : sources.backend},
               {"limits",
                {{"memory_bytes", limits.memory_bytes},
                 {"upload_bytes", limits.upload_bytes},
                 {"triangles", limits.triangles},
                 {"poses", limits.poses},
                 {"connections", limits.connections},
                 {"sessions", limits.sessions},
                 {"loops", limits.loops}}}});
}

std::string devices_json(const Parts& parts) {
  ordered_json devices = ordered_json::array();
  for (const DeviceLine& line : parts.list_devices())
    devices.push_back(
        {{"kind", line.kind}, {"name", line.name}, {"usable", line.usable}, {"reason", line.reason}});
  return dump({{"devices", devices}});
}

std::optional<HttpResponse> viewer_page(const std::string& path) {
  for (const ViewerFile& file : viewer_files())
    if (file.path == path) return page(file.type, file.content);
  return std::nullopt;
}

}  // namespace

void add_info_routes(Router& router, InfoSources sources) {
  router.add(
      {.method = "GET", .pattern = "healthz", .open = true, .handle = [](HttpRequest, const Reply& reply) {
         reply(HttpResponse(200, R"({"alive":true})"));
       }});
  router.add({.method = "GET",
              .pattern = "readyz",
              .open = true,
              .handle = [sources](HttpRequest, const Reply& reply) {
                const bool ready = !sources.stopping;
                reply(ready ? HttpResponse(200, R"({"ready":true})")
                            : HttpResponse(Problem{503, "busy", "the server stops", ""}));
              }});
  router.add({.method = "GET", .pattern = "metrics", .handle = [sources](HttpRequest, const Reply& reply) {
                auto gauges = sources.store.gauges();
                for (auto& gauge : sources.sessions.gauges()) gauges.push_back(std::move(gauge));
                reply(text("text/plain; version=0.0.4; charset=utf-8", sources.metrics.text(gauges)));
              }});
  router.add({.method = "GET",
              .pattern = "openapi.json",
              .open = true,
              .handle = [](HttpRequest, const Reply& reply) {
                reply(text("application/json", std::string(assets::openapi_json)));
              }});
  router.add({.method = "GET", .pattern = "v1/info", .handle = [sources](HttpRequest, const Reply& reply) {
                reply(HttpResponse(200, info_json(sources)));
              }});
  router.add({.method = "GET", .pattern = "v1/devices", .handle = [sources](HttpRequest, const Reply& reply) {
                sources.workers.post(
                    [sources, reply] { reply(HttpResponse(200, devices_json(sources.parts))); });
              }});
  router.add(
      {.method = "GET", .pattern = "", .open = true, .handle = [](HttpRequest, const Reply& reply) {
         reply(viewer_page("index.html")
                   .value_or(page("text/html; charset=utf-8", fmt::format(kNoViewer, viewer_missing()))));
       }});
  for (const ViewerFile& file : viewer_files())
    router.add(
        {.method = "GET",
         .pattern = std::string(file.path),
         .open = true,
         .handle = [&file](HttpRequest, const Reply& reply) { reply(page(file.type, file.content)); }});
}

}  // namespace palpate

#include "service/server/sessions/session_host.h"

#include <atomic>
#include <chrono>
#include <cmath>
#include <condition_variable>
#include <nlohmann/json.hpp>
#include <thread>

#include "service/loop/session.h"
#include "service/report/run_summary.h"
#include "service/server/http/json_input.h"
#include "service/server/http/safe_path.h"
#include "service/server/sessions/pausable_device.h"
#include "service/server/sessions/recording.h"
#include "service/server/sessions/telemetry.h"

namespace palpate {
namespace {

namespace fs = std::filesystem;
using nlohmann::ordered_json;

constexpr std::size_t kRemembered = 64;  ///< sessions that are over and can still be looked at

Problem unknown(const std::string& id) {
  return {404, "not-found", "there is no session " + shown_text(id), "id"};
}

}  // namespace

struct SessionHost::Session {
  std::string id, scene, device_name, record;
  std::optional<double> duration_s;
  std::int64_t started = 0;  ///< Unix time, s
  SceneUse use;
  std::unique_ptr<BackendInTurns> backend;
  std::unique_ptr<HapticDevice> device;
  std::unique_ptr<PausableDevice> pausable;
  std::unique_ptr<Recording> recording;
  std::shared_ptr<Telemetry> telemetry;
  double stiffness = 0, max_force = 0;
  std::vector<std::string> stages;
  std::atomic<bool> stop{false};
  std::thread thread;
  std::mutex joining;

  mutable std::mutex mutex;         // for what follows
  std::condition_variable settled;  ///< `open` or `over` has come true
  bool paused = false, open = false, over = false;
  std::optional<Error> error;
  ordered_json summary;

  void join() {
    const std::lock_guard lock(joining);
    if (thread.joinable()) thread.join();
  }

  void opened() {
    {
      const std::lock_guard lock(mutex);
      open = true;
    }
    settled.notify_all();
  }

  /// Waits until the device is open. Why it never was, if so.
  std::optional<Error> wait_open() {
    std::unique_lock lock(mutex);
    settled.wait(lock, [this] { return open || over; });
    return open ? std::nullopt : error;
  }

  bool is_over() const {
    const std::lock_guard lock(mutex);
    return over;
  }

  std::string json() const {
    const TickRecord tick = telemetry->last_tick();
    const Telemetry::Punctuality told = telemetry->punctuality();
    const std::lock_guard lock(mutex);
    const char* state = over ? (error ? "failed" : "ended") : paused ? "paused" : "running";
    return dump(
        {{"id", id},
         {"scene", scene},
         {"device", device_name},
         {"state", state},
         {"started", started},
         {"duration_s", duration_s ? ordered_json(*duration_s) : ordered_json()},
         {"record", record.empty() ? ordered_json() : ordered_json(record)},
         {"viewers", telemetry->viewers()},
         {"tick", tick.tick},
         {"time_s", tick.time_s},
         {"missed_ticks", tick.missed_ticks},
         {"result_age_ticks", {{"p50", told.age_p50}, {"p99", told.age_p99}, {"max", told.age_max}}},
         {"lateness_us",
          {{"p50", told.lateness_us_p50}, {"p99", told.lateness_us_p99}, {"max", told.lateness_us_max}}},
         {"error", error ? ordered_json::parse(problem_of(*error).json()) : ordered_json()},
         {"summary", summary}});
  }

  void run(Log& log) {
    SessionOptions options;
    options.duration_s = duration_s;
    options.stop = &stop;
    options.room = options.give_way = true;
    Result<SessionSummary> outcome = Error{};
    try {
      outcome = run_session(use->operator*().loaded, *backend, *pausable, options, telemetry.get());
    } catch (const std::exception& failure) {
      outcome = Error{ErrorCode::kInternal, std::string("the session failed: ") + failure.what()};
    }
    std::optional<Error> why;
    if (!outcome)
      why = outcome.error();
    else if (outcome->failure)
      why = *outcome->failure;
    if (recording) {
      const HostedScene& hosted = **use;
      const std::string engine = outcome ? outcome->backend + " on " + outcome->device : "";
      const auto finished =
          recording->finish(outcome ? &*outcome : nullptr, hosted.loaded,
                            {"realtime", hosted.load_s, hosted.prepare_s,
                             provenance_of(hosted.loaded.scene, hosted.plan, engine, "palpate serve")});
      if (!finished && !why) why = finished.error();
    }
    const std::string text = outcome ? summary_json(*outcome) : "null";
    {
      const std::lock_guard lock(mutex);
      over = true;
      error = why;
      summary = ordered_json::parse(text, nullptr, false);
    }
    settled.notify_all();
    if (open)
      log.info(
          "session_over",
          {{"session", id}, {"error", why ? why->sentence : ""}, {"ticks", outcome ? outcome->ticks : 0}});
    telemetry->finish(why ? "the session failed" : stop ? "the session was stopped" : "the session is over");
    // The device and the scene are free again before anybody can see that it is over twice.
    use.reset();
  }
};

SessionHost::SessionHost(const Parts& parts, SceneStore& store, const ServerLimits& limits, Metrics& metrics,
                         Log& log, fs::path root)
    : parts_(parts), store_(store), limits_(limits), metrics_(metrics), log_(log), root_(std::move(root)) {}

SessionHost::~SessionHost() { stop_all(); }

std::shared_ptr<SessionHost::Session> SessionHost::find(const std::string& id) const {
  const std::lock_guard lock(mutex_);
  for (const auto& session : sessions_)
    if (session->id == id) return session;
  return nullptr;
}

void SessionHost::forget_old() {
  std::size_t over = 0;
  for (const auto& session : sessions_) over += session->is_over();
  for (auto it = sessions_.begin(); over > kRemembered && it != sessions_.end();) {
    if (!(*it)->is_over()) {
      ++it;
      continue;
    }
    (*it)->join();
    it = sessions_.erase(it);
    --over;
  }
}

std::variant<std::string, Problem> SessionHost::start(const Request& request) {
  if (request.duration_s && !(*request.duration_s > 0 && *request.duration_s <= 1e6))
    return bad_request("duration_s is not above 0 and at most 1e6", "duration_s");
  if (!request.record.empty() && (root_.empty() || !plain_name(request.record)))
    return bad_request(
        root_.empty()
            ? "this server has no folder for recordings (see --root)"
            : "\"record\" is letters, digits, '.', '_', '-' only, at most 100, without a dot in front",
        "record");
  auto use = store_.use(request.scene, true);
  if (auto* problem = std::get_if<Problem>(&use)) {
    problem->field = "scene";
    return *problem;
  }
  auto session = std::make_shared<Session>();
  session->use = std::get<SceneUse>(use);
  HostedScene& scene = **session->use;
  session->scene = request.scene;
  session->duration_s = request.duration_s;
  session->device_name = request.device.empty() ? scene.loaded.scene.device.driver : request.device;
  session->stiffness = scene.loaded.scene.response.stiffness_n_per_m;
  session->stages = scene.loaded.scene.stage_names;
  session->started =
      std::chrono::duration_cast<std::chrono::seconds>(std::chrono::system_clock::now().time_since_epoch())
          .count();
  const bool simulated = session->device_name == "simulated";
  if (session->device_name.starts_with("replay:"))
    return bad_request(
        "a session replays the trace that its scene names: device.path beside \"driver\": \"replay\"",
        "device");
  const bool is_file = session->device_name == "replay";

  std::unique_lock lock(mutex_);
  if (closed_) return Problem{503, "busy", "the server stops", ""};
  forget_old();
  std::size_t running = 0;
  for (const auto& other : sessions_) {
    if (other->is_over()) continue;
    ++running;
    if (!simulated && !is_file && other->device_name == session->device_name)
      return Problem{409, "conflict",
                     "the device " + session->device_name + " is in use by session " + other->id, "device"};
  }
  if (running >= limits_.sessions)
    return Problem{503, "busy", "there are " + std::to_string(running) + " sessions already; stop one", ""};
  auto device =
      parts_.make_device(session->device_name, scene.loaded.scene, scene.loaded.geometry.tool_gc_m, "");
  if (!device)
    return device.error().code == ErrorCode::kNoDevice ? problem_of(device.error(), "device")
                                                       : bad_request(device.error().sentence, "device");
  session->device = std::move(*device);
  session->max_force = session->device->capabilities().max_force_n;
  session->pausable =
      std::make_unique<PausableDevice>(*session->device, simulated, [session = session.get(), this] {
        log_.info("session_started",
                  {{"session", session->id}, {"scene", session->scene}, {"device", session->device_name}});
        session->opened();
      });
  session->backend = std::make_unique<BackendInTurns>(*scene.backend, session->use->turns());
  const fs::path folder = root_ / request.record;
  if (!request.record.empty()) {
    std::error_code error;
    if (!fs::create_directory(folder, error))
      return Problem{error ? 507u : 409u, error ? "storage" : "conflict",
                     "the folder '" + request.record + "' " +
                         (error ? "can't be made: " + error.message() : "is there already"),
                     "record"};
    auto recording = Recording::create(folder, report_focus(scene.loaded));
    if (!recording) return Problem{507, "storage", recording.error().sentence, "record"};
    session->recording = std::move(*recording);
    session->record = request.record;
  }
  session->telemetry = std::make_shared<Telemetry>(metrics_, session->recording.get());
  session->id = "s" + std::to_string(++count_);
  sessions_.push_back(session);
  session->thread = std::thread([session = session.get(), this] { session->run(log_); });
  lock.unlock();  // a device may take its time, and others may be stopped meanwhile
  if (const std::optional<Error> error = session->wait_open()) {
    session->join();
    {
      const std::lock_guard again(mutex_);
      sessions_.remove(session);
    }
    std::error_code ignored;
    if (session->recording) fs::remove_all(folder, ignored);  // its name is free for the next try
    return problem_of(*error, error->code == ErrorCode::kNoDevice ? "device" : "");
  }
  return session->json();
}

std::optional<std::string> SessionHost::view(const std::string& id) const {
  const auto session = find(id);
  if (!session) return std::nullopt;
  return session->json();
}

std::string SessionHost::all() const {
  const std::lock_guard lock(mutex_);
  std::string text = "{\"sessions\":[";
  for (const auto& session : sessions_) text += (text.back() == '[' ? "" : ",") + session->json();
  return text + "]}";
}

std::variant<std::string, Problem> SessionHost::set_paused(const std::string& id, bool paused) {
  const auto session = find(id);
  if (!session) return unknown(id);
  if (session->is_over()) return Problem{409, "conflict", "the session is over", "id"};
  session->pausable->set_paused(paused);
  {
    const std::lock_guard lock(session->mutex);
    session->paused = paused;
  }
  return session->json();
}

std::variant<std::string, Problem> SessionHost::stop(const std::string& id) {
  const auto session = find(id);
  if (!session) return unknown(id);
  session->stop = true;
  session->join();
  return session->json();
}

std::variant<std::shared_ptr<SocketHandler>, Problem> SessionHost::watch(const std::string& id, bool binary) {
  const auto session = find(id);
  if (!session) return unknown(id);
  std::string hello = dump({{"type", "hello"},
                            {"session", session->id},
                            {"scene", session->scene},
                            {"stiffness", session->stiffness},
                            {"device", session->device_name},
                            {"max_force", session->max_force},
                            {"stages", session->stages}});
  return make_viewer(session->telemetry, std::move(hello), binary, metrics_);
}

void SessionHost::stop_all() {
  std::list<std::shared_ptr<Session>> all;
  {
    const std::lock_guard lock(mutex_);
    closed_ = true;
    all = sessions_;
  }
  for (const auto& session : all) session->stop = true;  // within a tick each device is at zero
  for (const auto& session : all) session->join();
}

std::vector<Metrics::Gauge> SessionHost::gauges() const {
  const std::lock_guard lock(mutex_);
  double running = 0;
  for (const auto& session : sessions_) running += session->is_over() ? 0 : 1;
  return {{"palpate_sessions", "Sessions running.", running}};
}

void add_session_routes(Router& router, SessionHost& sessions, WorkerPool& workers,
                        const ServerLimits& limits) {
  const auto answer = [](const Reply& reply, std::variant<std::string, Problem> outcome, unsigned status) {
    if (const auto* problem = std::get_if<Problem>(&outcome)) return reply(*problem);
    reply(HttpResponse(status, std::get<std::string>(outcome)));
  };
  router.add(
      {.method = "GET", .pattern = "v1/sessions", .handle = [&sessions](HttpRequest, const Reply& reply) {
         reply(HttpResponse(200, sessions.all()));
       }});
  router.add(
      {.method = "POST",
       .pattern = "v1/sessions",
       .body_limit = limits.json_bytes,
       .handle = [&sessions, &workers, &limits, answer](HttpRequest request, Reply reply) {
         const auto read =
             read_json_object(request.body, limits.json_depth, {"scene", "device", "duration_s", "record"});
         if (const auto* problem = std::get_if<Problem>(&read)) return reply(*problem);
         const auto& json = std::get<nlohmann::json>(read);
         SessionHost::Request wanted;
         for (const auto& [key, into] :
              {std::pair{"scene", &wanted.scene}, {"device", &wanted.device}, {"record", &wanted.record}}) {
           if (!json.contains(key)) continue;
           if (!json[key].is_string())
             return reply(bad_request(std::string("\"") + key + "\" is no text", key));
           *into = json[key].get<std::string>();
         }
         if (wanted.scene.empty())
           return reply(bad_request("\"scene\" is wanted: the id of a scene", "scene"));
         if (json.contains("duration_s") && !json["duration_s"].is_null()) {
           if (!json["duration_s"].is_number())
             return reply(bad_request("\"duration_s\" is no number", "duration_s"));
           wanted.duration_s = json["duration_s"].get<double>();
         }
         workers.post([&sessions, wanted, reply, answer] { answer(reply, sessions.start(wanted), 201); });
       }});
  router.add({.method = "GET",
              .pattern = "v1/sessions/*",
              .handle = [&sessions](HttpRequest request, const Reply& reply) {
                const auto view = sessions.view(request.segments[2]);
                reply(view ? HttpResponse(200, *view) : HttpResponse(unknown(request.segments[2])));
              }});
  for (const bool paused : {true, false})
    router.add({.method = "POST",
                .pattern = paused ? "v1/sessions/*/pause" : "v1/sessions/*/resume",
                .handle = [&sessions, answer, paused](HttpRequest request, const Reply& reply) {
                  answer(reply, sessions.set_paused(request.segments[2], paused), 200);
                }});
  router.add({.method = "DELETE",
              .pattern = "v1/sessions/*",
              .handle = [&sessions, &workers, answer](HttpRequest request, Reply reply) {
                workers.post([&sessions, id = request.segments[2], reply, answer] {
                  answer(reply, sessions.stop(id), 200);
                });
              }});
  router.add(
      {.method = "GET",
       .pattern = "v1/sessions/*/stream",
       .parameters = {"format"},
       .socket =
           [&sessions](const HttpRequest& request) -> std::variant<std::shared_ptr<SocketHandler>, Problem> {
         const std::string format = request.query_or("format", "json");
         if (format != "json" && format != "binary")
           return bad_request("format is '" + shown_text(format) + "', allowed is json or binary", "format");
         return sessions.watch(request.segments[2], format == "binary");
       }});
}

}  // namespace palpate

#include "service/server/scenes/scene_routes.h"

#include <atomic>
#include <charconv>
#include <cmath>
#include <fstream>

#include "service/server/http/json_input.h"
#include "service/server/http/safe_path.h"
#include "service/server/scenes/content_hash.h"
#include "service/server/scenes/upload.h"

namespace palpate {
namespace {

namespace fs = std::filesystem;

constexpr double kLongestWait = 60;  ///< s
constexpr double kPing =
    10;  ///< s between signs of life of an event stream, so that a client that has gone is noticed
constexpr std::size_t kMostListed = 200;
constexpr int kDeepest = 4;  ///< folders below the root that are looked through

bool settled(SceneState state) {
  return state == SceneState::kReady || state == SceneState::kFailed || state == SceneState::kEvicted;
}

Problem unknown_scene(const std::string& id) {
  return {404, "not-found", "there is no scene " + shown_text(id), "id"};
}

/// Answers once the scene is settled, or when time is up.
class Wait : public std::enable_shared_from_this<Wait> {
 public:
  Wait(SceneStore& store, WorkerPool& workers, std::string id, Reply reply)
      : store_(store), workers_(workers), id_(std::move(id)), reply_(std::move(reply)) {}

  void start(double seconds) {
    listener_ = store_.listen([weak = weak_from_this(), &workers = workers_] {
      workers.post([weak] {
        if (const auto alive = weak.lock()) alive->look(false);
      });
    });
    workers_.after(seconds, [self = shared_from_this()] { self->look(true); });  // keeps this alive
    look(false);
  }

 private:
  void look(bool late) {
    const auto view = store_.view(id_);
    if (view && !settled(view->state) && !late) return;
    if (answered_.exchange(true)) return;
    reply_(view ? HttpResponse(200, view->json) : HttpResponse(unknown_scene(id_)));
  }

  SceneStore& store_;
  WorkerPool& workers_;
  std::string id_;
  Reply reply_;
  std::shared_ptr<void> listener_;
  std::atomic<bool> answered_{false};
};

/// Server-sent events of one scene's preparation.
class SceneEvents final : public BodySource, public std::enable_shared_from_this<SceneEvents> {
 public:
  SceneEvents(SceneStore& store, WorkerPool& workers, std::string id)
      : store_(store), workers_(workers), id_(std::move(id)) {}

  void start() {
    listener_ = store_.listen([weak = weak_from_this(), &workers = workers_] {
      workers.post([weak] {
        if (const auto alive = weak.lock()) alive->look(false);
      });
    });
  }

  void next(std::function<void(Chunk)> take) override {
    {
      const std::lock_guard lock(mutex_);
      take_ = std::move(take);
    }
    look(false);
    workers_.after(kPing, [weak = weak_from_this()] {
      if (const auto alive = weak.lock()) alive->look(true);
    });
  }

 private:
  void look(bool ping) {
    const auto view = store_.view(id_);
    std::function<void(Chunk)> take;
    Chunk chunk;
    {
      const std::lock_guard lock(mutex_);
      if (!take_) return;
      if (!view || view->state == SceneState::kEvicted) {
        chunk = {"event: gone\ndata: {}\n\n", true, false};
      } else if (view->version != seen_) {
        seen_ = view->version;
        const char* event = view->state == SceneState::kReady    ? "ready"
                            : view->state == SceneState::kFailed ? "failed"
                                                                 : "progress";
        chunk = {std::string("event: ") + event + "\ndata: " + view->json + "\n\n", settled(view->state),
                 false};
      } else if (ping) {
        chunk.data = ": still here\n\n";
      } else {
        return;
      }
      take = std::exchange(take_, nullptr);
    }
    take(std::move(chunk));
  }

  SceneStore& store_;
  WorkerPool& workers_;
  std::string id_;
  std::shared_ptr<void> listener_;
  std::mutex mutex_;
  std::function<void(Chunk)> take_;
  std::uint64_t seen_ = UINT64_MAX;
};

/// Whether a file is a scene's, to judge by its two bodies: a run's summary.json speaks of both as well.
bool is_scene(const fs::path& file, const ServerLimits& limits) {
  std::error_code error;
  if (fs::file_size(file, error) > limits.json_bytes || error) return false;
  std::ifstream in(file, std::ios::binary);
  const std::string text((std::istreambuf_iterator<char>(in)), std::istreambuf_iterator<char>());
  const auto read = read_json_object(text, limits.json_depth);
  const auto* json = std::get_if<nlohmann::json>(&read);
  return json && json->contains("static") && (*json)["static"].is_array() && json->contains("tool") &&
         (*json)["tool"].is_object();
}

/// Scene files below the root.
std::vector<std::string> available(const fs::path& root, const ServerLimits& limits) {
  std::vector<std::string> found;
  std::error_code error;
  if (root.empty()) return found;
  for (auto it = fs::recursive_directory_iterator(root, fs::directory_options::skip_permission_denied, error);
       !error && it != fs::recursive_directory_iterator(); it.increment(error)) {
    if (it.depth() >= kDeepest) it.disable_recursion_pending();
    if (it->path().extension() != ".json" || it->path().filename().string().ends_with(".schema.json") ||
        !it->is_regular_file(error))
      continue;
    if (is_scene(it->path(), limits)) found.push_back(fs::relative(it->path(), root, error).string());
    if (found.size() == kMostListed) break;
  }
  std::sort(found.begin(), found.end());
  return found;
}

HttpResponse added(SceneStore& store, SceneContent content) {
  const std::string id = content.id;
  auto answer = store.add(std::move(content));
  if (const auto* problem = std::get_if<Problem>(&answer)) return *problem;
  const auto& view = std::get<SceneStore::View>(answer);
  HttpResponse response(view.state == SceneState::kReady ? 200 : 202, view.json);
  response.headers.emplace_back("Location", "/v1/scenes/" + id);
  return response;
}

/// Another scene than the file's, so another id.
void leave_out_start(SceneContent& content) {
  ContentHash hash;
  hash.add("palpate scene 1, ignore_initial\n" + content.id);
  content.id = hash.hex().substr(0, 32);
  content.ignore_initial = true;
  content.name += ", without the contacts at the start";
}

HttpResponse add_named(const std::string& body, SceneStore& store, const ServerLimits& limits,
                       const fs::path& root) {
  const auto read = read_json_object(body, limits.json_depth, {"path", "profile", "start", "engine"});
  if (const auto* problem = std::get_if<Problem>(&read)) return *problem;
  const auto& json = std::get<nlohmann::json>(read);
  if (!json.contains("path") || !json["path"].is_string())
    return bad_request("\"path\" is wanted: a scene file below the root", "path");
  const std::string path = json["path"];
  std::optional<Profile> profile;
  if (json.contains("profile")) {
    if (json["profile"] != "paper" && json["profile"] != "refined")
      return bad_request("\"profile\" is paper or refined", "profile");
    profile = json["profile"] == "paper" ? Profile::kPaper : Profile::kRefined;
  }
  if (json.contains("start") && json["start"] != "as_written" && json["start"] != "ignore_initial")
    return bad_request("\"start\" is as_written or ignore_initial", "start");
  const bool ignore_initial = json.contains("start") && json["start"] == "ignore_initial";
  if (ignore_initial && profile == Profile::kPaper)
    return bad_request("\"start\" ignore_initial is of profile refined; in paper contacts of the start push",
                       "start");
  if (root.empty())
    return Problem{404, "not-found", "this server has no folder of scenes (see --root); upload one", "path"};
  const bool sane = !path.empty() && path.size() <= 1024 && path.find('\0') == std::string::npos;
  const auto file = sane ? path_below(root, path) : std::nullopt;
  std::error_code error;
  if (!file) {
    // Whether something lies outside is nobody's business: what leads out is refused alike, be it there or
    // not.
    const fs::path straight = fs::path(path).lexically_normal();
    const bool leads_out = straight.is_absolute() || (!straight.empty() && *straight.begin() == "..") ||
                           fs::exists(fs::symlink_status(root / straight, error));
    if (sane && leads_out)
      return Problem{403, "outside-root", "'" + shown_text(path) + "' lies outside the root", "path"};
    return Problem{404, "not-found", "there is no scene file '" + shown_text(path) + "' below the root",
                   "path"};
  }
  if (!fs::is_regular_file(*file, error))
    return Problem{404, "not-found", "'" + shown_text(path) + "' is no file", "path"};
  auto content = read_scene_content(*file, root, profile, limits, Neighbours::kByTime);
  if (const auto* problem = std::get_if<Problem>(&content)) return *problem;
  auto& found = std::get<SceneContent>(content);
  found.name = fs::relative(*file, root, error).string();
  if (ignore_initial) leave_out_start(found);
  if (json.contains("engine"))
    if (auto problem = choose_engine(json["engine"], found)) return *problem;
  return added(store, std::move(found));
}

}  // namespace

void add_scene_routes(Router& router, SceneStore& store, WorkerPool& workers, Metrics& metrics,
                      const ServerLimits& limits, const fs::path& root, const fs::path& spool) {
  router.add({.method = "GET",
              .pattern = "v1/scenes",
              .handle = [&store, &workers, &limits, root](HttpRequest, Reply reply) {
                workers.post([&store, &limits, root, reply] {
                  std::string text = "{\"scenes\":[";
                  for (const auto& view : store.all()) text += (text.back() == '[' ? "" : ",") + view.json;
                  nlohmann::ordered_json names = nlohmann::ordered_json::array();
                  for (const std::string& name : available(root, limits)) names.push_back(name);
                  reply(HttpResponse(200, text + "],\"available\":" + dump(names) + "}"));
                });
              }});
  router.add({.method = "POST",
              .pattern = "v1/scenes",
              .body_limit = limits.json_bytes,
              .handle =
                  [&store, &workers, &limits, root](HttpRequest request, Reply reply) {
                    if (media_type(request.content_type) != "application/json")
                      return reply(Problem{
                          415, "media-type",
                          "a scene comes as multipart/form-data or is named in application/json, not as '" +
                              shown_text(request.content_type) + "'",
                          "Content-Type"});
                    workers.post([&store, &limits, root, body = std::move(request.body), reply] {
                      reply(add_named(body, store, limits, root));
                    });
                  },
              .sink_type = "multipart/form-data",
              .sink_limit = limits.upload_bytes,
              .sink =
                  [&store, &workers, &metrics, &limits, spool](const HttpRequest& request) {
                    return receive_upload(request, spool, limits, metrics, workers,
                                          [&store](SceneContent content, const Reply& reply) {
                                            reply(added(store, std::move(content)));
                                          });
                  }});
  router.add({.method = "GET",
              .pattern = "v1/scenes/*",
              .parameters = {"wait"},
              .handle = [&store, &workers](HttpRequest request, Reply reply) {
                const std::string& id = request.segments[2];
                const std::string wait = request.query_or("wait", "0");
                double seconds = 0;
                const auto [stop, error] = std::from_chars(wait.data(), wait.data() + wait.size(), seconds);
                if (error != std::errc() || stop != wait.data() + wait.size() ||
                    !(seconds >= 0 && seconds <= kLongestWait))
                  return reply(
                      bad_request("wait is '" + shown_text(wait) + "', allowed is 0 to 60 s", "wait"));
                if (seconds > 0) return std::make_shared<Wait>(store, workers, id, reply)->start(seconds);
                const auto view = store.view(id);
                reply(view ? HttpResponse(200, view->json) : HttpResponse(unknown_scene(id)));
              }});
  router.add({.method = "DELETE",
              .pattern = "v1/scenes/*",
              .handle = [&store, &workers](HttpRequest request, Reply reply) {
                workers.post([&store, id = request.segments[2], reply] {
                  if (auto problem = store.remove(id)) return reply(*problem);
                  reply(HttpResponse(204, ""));
                });
              }});
  router.add({.method = "GET",
              .pattern = "v1/scenes/*/events",
              .handle = [&store, &workers](HttpRequest request, Reply reply) {
                const std::string& id = request.segments[2];
                if (!store.view(id)) return reply(unknown_scene(id));
                const auto events = std::make_shared<SceneEvents>(store, workers, id);
                events->start();
                HttpResponse response;
                response.type = "text/event-stream";
                response.source = events;
                reply(std::move(response));
              }});
}

}  // namespace palpate

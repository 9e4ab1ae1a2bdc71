#include "service/server/scenes/drawing_routes.h"

#include <charconv>
#include <list>
#include <mutex>
#include <tuple>

#include "service/server/http/json_input.h"
#include "service/server/scenes/drawing.h"

namespace palpate {
namespace {

constexpr std::size_t kPiece = 256 << 10;
constexpr std::size_t kMostIds = 100'000;
constexpr std::size_t kKeptVoxels =
    8;  ///< answers remembered, so that a loop that has begun meanwhile need not be disturbed

template <class T>
void put(std::string& out, const T& value) {
  out.append(reinterpret_cast<const char*>(&value), sizeof value);
}

void put_point(std::string& out, const Vec3& p) {
  for (int k = 0; k < 3; ++k) put(out, static_cast<float>(p[k]));
}

/// A body as it stands, or reduced.
struct Body {
  BodyView view;
  std::optional<DrawnMesh> drawn{};

  std::size_t vertices() const { return drawn ? drawn->vertices.size() : view.mesh.vertices.size(); }
  Vec3 vertex(std::size_t i) const { return drawn ? drawn->vertices[i] : view.point(i); }
  const std::vector<std::array<std::uint32_t, 3>>& triangles() const {
    return drawn ? drawn->triangles : view.mesh.triangles;
  }
  std::uint32_t id(std::size_t i) const { return drawn ? drawn->ids[i] : static_cast<std::uint32_t>(i); }
};

BodyView view_of(const SceneGeometry& geometry, bool tool) {
  if (tool) return {geometry.tool, geometry.tool_centre_m, geometry.lattice.step_m};
  return {geometry.mockup, geometry.lattice.origin_m, geometry.lattice.step_m};
}

/// `PGEO`, made as it is sent. `tool`: that body alone, the other one has nothing.
class Geometry final : public BodySource {
 public:
  Geometry(SceneUse use, std::optional<bool> tool, std::optional<std::size_t> most)
      : use_(std::move(use)),
        bodies_{Body{view_of((*use_)->loaded.geometry, false)},
                Body{view_of((*use_)->loaded.geometry, true)}} {
    bool any = false;
    if (tool) bodies_[*tool ? 0 : 1].drawn.emplace();
    for (Body& body : bodies_)
      if (most && body.triangles().size() > *most) {
        body.drawn = reduced(body.view, *most);
        any = true;
      }
    head_ = "PGEO";
    put(head_, std::uint32_t{1});
    put(head_, std::uint32_t{any ? 1u : 0u});
    for (const Body& body : bodies_) {
      put(head_, static_cast<std::uint32_t>(body.vertices()));
      put(head_, static_cast<std::uint32_t>(body.triangles().size()));
    }
    put(head_, std::uint32_t{0});
  }

  std::uint64_t length() const {
    std::uint64_t sum = head_.size();
    for (const Body& body : bodies_) sum += body.vertices() * 12 + body.triangles().size() * 16;
    return sum;
  }

  void next(std::function<void(Chunk)> take) override {
    Chunk chunk;
    chunk.data = std::exchange(head_, {});
    while (section_ < 6 && chunk.data.size() < kPiece) {
      const Body& body = bodies_[section_ / 3];
      const std::size_t count = section_ % 3 == 0 ? body.vertices() : body.triangles().size();
      for (; item_ < count && chunk.data.size() < kPiece; ++item_) {
        if (section_ % 3 == 0) put_point(chunk.data, body.vertex(item_));
        if (section_ % 3 == 1) put(chunk.data, body.triangles()[item_]);
        if (section_ % 3 == 2) put(chunk.data, body.id(item_));
      }
      if (item_ < count) break;
      ++section_;
      item_ = 0;
    }
    chunk.last = section_ == 6;
    take(std::move(chunk));
  }

 private:
  SceneUse use_;
  Body bodies_[2];
  std::string head_;
  std::size_t section_ = 0, item_ = 0;  ///< vertices, corners, ids of the mock-up, then of the tool
};

HttpResponse binary(std::string body) {
  HttpResponse response(200, std::move(body));
  response.type = "application/octet-stream";
  return response;
}

/// "static" or "tool"; nothing: neither.
std::optional<bool> is_tool(const HttpRequest& request) {
  const std::string body = request.query_or("body", "static");
  if (body == "static" || body == "tool") return body == "tool";
  return std::nullopt;
}

Problem bad_body() { return bad_request("body is neither static nor tool", "body"); }

HttpResponse geometry(SceneStore& store, const HttpRequest& request) {
  std::optional<std::size_t> most;
  if (const std::string text = request.query_or("max_triangles", ""); !text.empty()) {
    std::size_t value = 0;
    const auto [stop, error] = std::from_chars(text.data(), text.data() + text.size(), value);
    if (error != std::errc() || stop != text.data() + text.size() || value < 100)
      return bad_request("max_triangles is '" + shown_text(text) + "', allowed is a number from 100",
                         "max_triangles");
    most = value;
  }
  const auto tool = is_tool(request);
  if (!tool) return bad_body();
  auto use = store.use(request.segments[2], false);
  if (const auto* problem = std::get_if<Problem>(&use)) return *problem;
  const bool both = request.query_or("body", "").empty();
  const auto source =
      std::make_shared<Geometry>(std::get<SceneUse>(use), both ? std::optional<bool>() : tool, most);
  HttpResponse response = binary({});
  response.source = source;
  response.source_length = source->length();
  return response;
}

HttpResponse triangles(SceneStore& store, const HttpRequest& request) {
  const auto tool = is_tool(request);
  if (!tool) return bad_body();
  auto use = store.use(request.segments[2], false);
  if (const auto* problem = std::get_if<Problem>(&use)) return *problem;
  const BodyView body = view_of((*std::get<SceneUse>(use))->loaded.geometry, *tool);
  const auto ids = parse_ids(request.query_or("ids", ""), body.mesh.triangles.size(), kMostIds);
  if (!ids)
    return bad_request(
        "ids is no list like 1,5-9 of at most 100000 ids below " + std::to_string(body.mesh.triangles.size()),
        "ids");
  std::string out;
  for (const std::uint32_t id : *ids)
    for (const std::uint32_t v : body.mesh.triangles[id]) put_point(out, body.point(v));
  return binary(std::move(out));
}

/// Which triangles belong to which part: its first is the sum of those before it.
HttpResponse scene_parts(SceneStore& store, const HttpRequest& request) {
  auto use = store.use(request.segments[2], false);
  if (const auto* problem = std::get_if<Problem>(&use)) return *problem;
  const SceneGeometry& geometry = (*std::get<SceneUse>(use))->loaded.geometry;
  nlohmann::ordered_json out;
  for (const auto& [name, report] :
       {std::pair{"static", &geometry.mockup_report}, {"tool", &geometry.tool_report}}) {
    auto& list = out[name] = nlohmann::ordered_json::array();
    for (const MeshReport::Part& part : report->parts)
      list.push_back({{"path", part.path}, {"triangles", part.triangles}});
  }
  return {200, dump(out)};
}

/// Voxels of the classes that were asked for last.
class VoxelAnswers {
 public:
  HttpResponse get(SceneStore& store, const ServerLimits& limits, const HttpRequest& request) {
    const auto tool = is_tool(request);
    if (!tool) return bad_body();
    const std::string name = request.query_or("class", "boundary");
    if (name != "boundary" && name != "internal")
      return bad_request("class is '" + shown_text(name) + "', allowed is boundary or internal", "class");
    const std::string key = request.segments[2] + (*tool ? "t" : "s") + name;
    auto use = store.use(request.segments[2], false);
    if (const auto* problem = std::get_if<Problem>(&use)) return *problem;
    const SceneLease& scene = *std::get<SceneUse>(use);
    const std::lock_guard lock(mutex_);  // one at a time: a partition is large
    for (const auto& [kept, bytes] : kept_)
      if (kept == key) return binary(bytes);
    std::optional<Result<VoxelPartition>> partition;
    if (scene.loops() > 0) {  // reading voxels would hold them up
      const Aside aside = store.aside(scene);
      if (!aside.backend)
        return Problem{
            409, "conflict",
            "a loop uses the scene, and there is no memory to read voxels beside it; ask when it has ended",
            "id"};
      partition = aside.backend->partition(*tool);
    } else {
      const TurnGuard turn(scene.turns(), TurnGuard::Kind::kLoop);
      partition = scene->backend->partition(*tool);
    }
    if (!*partition) return problem_of(partition->error());
    const SceneGeometry& geometry = scene->loaded.geometry;
    auto bytes = voxel_bytes(**partition, name == "internal" ? VoxelClass::kInternal : VoxelClass::kBoundary,
                             *tool, *tool ? geometry.tool_centre_m : geometry.lattice.origin_m,
                             geometry.lattice.step_m, limits.voxels);
    if (!bytes)
      return Problem{413, "too-large",
                     "there are more than " + std::to_string(limits.voxels) + " voxels of this class",
                     "class"};
    kept_.emplace_back(key, *bytes);
    if (kept_.size() > kKeptVoxels) kept_.pop_front();
    return binary(std::move(*bytes));
  }

 private:
  std::mutex mutex_;
  std::list<std::pair<std::string, std::string>> kept_;
};

}  // namespace

void add_drawing_routes(Router& router, SceneStore& store, WorkerPool& workers, const ServerLimits& limits) {
  router.add({.method = "GET",
              .pattern = "v1/scenes/*/geometry",
              .parameters = {"max_triangles", "body"},
              .handle = [&](HttpRequest request, Reply reply) {
                workers.post(
                    [&store, request = std::move(request), reply] { reply(geometry(store, request)); });
              }});
  router.add({.method = "GET",
              .pattern = "v1/scenes/*/triangles",
              .parameters = {"body", "ids"},
              .handle = [&](HttpRequest request, Reply reply) {
                workers.post(
                    [&store, request = std::move(request), reply] { reply(triangles(store, request)); });
              }});
  router.add(
      {.method = "GET", .pattern = "v1/scenes/*/parts", .handle = [&](HttpRequest request, Reply reply) {
         workers.post([&store, request = std::move(request), reply] { reply(scene_parts(store, request)); });
       }});
  router.add({.method = "GET",
              .pattern = "v1/scenes/*/voxels",
              .parameters = {"class", "body"},
              .handle = [&, answers = std::make_shared<VoxelAnswers>()](HttpRequest request, Reply reply) {
                workers.post([&store, &limits, answers, request = std::move(request), reply] {
                  reply(answers->get(store, limits, request));
                });
              }});
}

}  // namespace palpate

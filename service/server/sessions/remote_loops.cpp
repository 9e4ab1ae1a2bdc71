#include "service/server/sessions/remote_loops.h"

#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstring>
#include <iterator>
#include <nlohmann/json.hpp>
#include <utility>

#include "service/loop/collision_frame.h"
#include "service/loop/thread_share.h"
#include "service/queries/lone_query.h"
#include "service/queries/query_json.h"
#include "service/server/http/json_input.h"
#include "service/server/queries/pose_body.h"
#include "service/server/sessions/json_text.h"

namespace palpate {
namespace {

constexpr std::uint32_t kContact = 1, kTruncated = 2,
                        kStopped = 4;  ///< bits of a binary wrench (docs/SERVICE.md)

using Clock = std::chrono::steady_clock;
using nlohmann::ordered_json;

constexpr std::uint16_t kPolicyViolation = 1008, kInternalError = 1011;  ///< of a close (RFC 6455, 7.4.1)

constexpr std::size_t kPoseMessage = 16 + 7 * sizeof(double);  ///< seq, time, pose

/// A pose on its way, with what comes back as it was sent.
struct PoseMessage {
  std::uint64_t seq = 0;
  double time = 0;
  Pose pose;
  bool full = false, area_lists = true, near = false, planes = false, binary = false;
  Clock::time_point arrived{};
};

std::variant<PoseMessage, Problem> read_message(std::string_view data, bool binary, std::size_t depth) {
  PoseMessage out;
  out.arrived = Clock::now();
  out.binary = binary;
  if (binary) {
    if (data.size() != kPoseMessage)
      return bad_request("a pose message has 72 bytes, not " + std::to_string(data.size()), "message");
    std::memcpy(&out.seq, data.data(), 8);
    std::memcpy(&out.time, data.data() + 8, 8);
    const auto pose = pose_from_bytes(data.data() + 16, "pose");
    if (const auto* problem = std::get_if<Problem>(&pose)) return *problem;
    out.pose = std::get<Pose>(pose);
    return out;
  }
  const auto read =
      read_json_object(data, depth, {"type", "seq", "time", "pose", "full", "area_lists", "near", "planes"});
  if (const auto* problem = std::get_if<Problem>(&read)) return *problem;
  const auto& json = std::get<nlohmann::json>(read);
  if (!json.contains("type") || json["type"] != "pose")
    return bad_request("\"type\" is not \"pose\"", "type");
  if (!json.contains("seq") || !json["seq"].is_number_unsigned())
    return bad_request("\"seq\" is no whole number from 0", "seq");
  out.seq = json["seq"];
  if (json.contains("time")) {
    if (!json["time"].is_number()) return bad_request("\"time\" is no number", "time");
    out.time = json["time"];
  }
  for (const auto& [key, value] : {std::pair{"full", &out.full},
                                   {"area_lists", &out.area_lists},
                                   {"near", &out.near},
                                   {"planes", &out.planes}}) {
    if (!json.contains(key)) continue;
    if (!json[key].is_boolean())
      return bad_request(fmt::format("\"{}\" is neither true nor false", key), key);
    *value = json[key];
  }
  const auto pose = pose_from_json(json.contains("pose") ? json["pose"] : nlohmann::json(), "pose");
  if (const auto* problem = std::get_if<Problem>(&pose)) return *problem;
  out.pose = std::get<Pose>(pose);
  return out;
}

/// The last message of a loop that goes no further.
SocketMessage error_message(const Problem& problem) {
  return {R"({"type":"error","problem":)" + problem.json() + "}", nullptr, false, true,
          problem.status < 500 ? kPolicyViolation : kInternalError};
}

/// The start of a binary wrench; planes follow it.
void put_wrench_head(const PoseMessage& pose, const Wrench& wrench, const Vec3& gc, double us,
                     std::uint32_t skipped, std::uint32_t bits, std::uint32_t planes, std::string& out) {
  const auto put = [&out](const auto& value) {
    out.append(reinterpret_cast<const char*>(&value), sizeof value);
  };
  put(pose.seq);
  put(pose.time);
  for (const Vec3& v : {wrench.force, wrench.torque, gc})
    for (int i = 0; i < 3; ++i) put(double{v[i]});
  put(static_cast<float>(us));
  for (const std::uint32_t word : {skipped, bits, planes}) put(word);
}

/// `refined`: what is felt, as one area: a client carries the force on along a wall as stiff as the spring.
/// None without a force, for a couple has no wall.
std::vector<AreaResponse> felt_area(const ContactResponse& response, double stiffness) {
  const Wrench& felt = response.told();
  const double force = glm::length(felt.force);
  if (!(force > 0) || !(stiffness > 0)) return {};
  AreaResponse area{.normal = felt.force / force,
                    .depth = force / stiffness,
                    .max_depth = force / stiffness,
                    .force = felt.force};
  area.point = response.gc + glm::cross(felt.force, felt.torque) /
                                 (force * force);  // what the torque has along the force is no wall's
  area.torque = glm::cross(area.point - response.gc, area.force);
  return {area};
}

/// Appends what pushes at the pose and how that gives way, as a session's control law gets it.
void put_planes(const PlaneSet& set, std::string& out) {
  out += R"(,"planes":[)";
  for (std::uint32_t i = 0; i < set.plane_count; ++i) {
    const ContactPlane& plane = set.planes[i];
    fmt::format_to(std::back_inserter(out), R"({}{{"normal":{},"lever":{},"force":{},"stiffness":{}}})",
                   i ? "," : "", json_text(plane.normal), json_text(plane.lever), json_text(plane.force),
                   json_text(plane.stiffness));
  }
  out += "]";
}

/// What a loop hears last: nothing pushes any more.
SocketMessage zero_wrench(const PoseMessage& pose, const Vec3& gc) {
  SocketMessage message;
  message.binary = pose.binary;
  if (pose.binary)
    put_wrench_head(pose, {}, gc, 0, 0, kStopped, 0, message.head);
  else
    message.head = fmt::format(
        R"({{"type":"wrench","seq":{},"time":{},"skipped":0,"server_us":0,"contact":false,"truncated":false,"stopped":true,"pairs":0,"gc":{},"force":[0,0,0],"torque":[0,0,0],"areas":[]}})",
        pose.seq, json_text(pose.time), json_text(gc));
  return message;
}

}  // namespace

struct RemoteLoops::Loop {
  explicit Loop(SceneUse scene)
      : use(std::move(scene)),
        backend(*(*use)->backend, use->turns()),
        frame((*use)->loaded.geometry, backend, (*use)->loaded.scene.response.profile,
              (*use)->loaded.scene.response.stiffness_n_per_m, true, nullptr,
              (*use)->loaded.scene.start_contacts),
        lone((*use)->loaded.geometry, (*use)->loaded.scene.response.stiffness_n_per_m),
        field((*use)->loaded.scene.response.profile == Profile::kRefined) {}

  /// The pose in `slot`: what would be felt there, unless its planes are wanted. `near`: from the answer
  /// before on.
  Result<void> solve(const PoseMessage& asked) noexcept {
    if (auto solved = frame.solve(slot, result); !solved || !field || asked.planes || !slot.response.contact)
      return solved;
    try {
      return lone.feel(backend, frame.ignored(), slot.sample.pose, slot.response, asked.near);
    } catch (const std::exception& error) {  // a library's, as in CollisionFrame::solve
      return Error{ErrorCode::kInternal, std::string("the collision query failed: ") + error.what()};
    } catch (...) {
      return Error{ErrorCode::kInternal, "the collision query failed for an unknown reason"};
    }
  }

  // The answering thread's:
  SceneUse use;
  BackendInTurns backend;
  CollisionFrame frame;
  LoneQuery lone;
  bool field;  ///< profile `refined`
  FrameSlot slot;
  LawResult result;
  std::int64_t count = 0;

  // Shared:
  std::mutex mutex;
  std::function<void()> wake;
  std::optional<PoseMessage> pose, newest;  ///< not taken up yet; the last that came
  std::optional<SocketMessage> reply;
  std::uint32_t reply_for = 0;  ///< poses: the one that it answers, and those skipped before it
  std::uint32_t skipped = 0;
  bool queued = false, closed = false;
};

/// The connection's end of a loop.
class RemoteLoops::Socket final : public SocketHandler {
 public:
  Socket(RemoteLoops& loops, std::shared_ptr<Loop> loop, std::string hello)
      : loops_(loops), metrics_(loops.metrics_), loop_(std::move(loop)), hello_(std::move(hello)) {
    ++metrics_.loops_now;
  }
  ~Socket() override {
    closed();
    --metrics_.loops_now;  // not by way of the loops: a connection may outlive them when the server stops
  }

  void start(std::function<void()> wake) override {
    const std::lock_guard lock(loop_->mutex);
    loop_->wake = std::move(wake);
  }

  void message(std::string_view data, bool binary) override {
    auto read = read_message(data, binary, loops_.limits_.json_depth);
    std::function<void()> wake;
    {
      const std::lock_guard lock(loop_->mutex);
      if (loop_->closed) return;
      if (const auto* problem = std::get_if<Problem>(&read)) {
        loop_->reply = error_message(*problem);
        loop_->closed = true;
        wake = loop_->wake;
      } else {
        if (loop_->pose) {
          ++loop_->skipped;
          ++loops_.metrics_.loop_skipped;
        }
        loop_->pose = loop_->newest = std::get<PoseMessage>(read);
      }
    }
    if (std::holds_alternative<PoseMessage>(read)) return loops_.submit(loop_);
    if (wake) wake();
  }

  std::optional<SocketMessage> next() override {
    if (!hello_.empty()) return SocketMessage{std::exchange(hello_, {}), nullptr, false, false};
    const std::lock_guard lock(loop_->mutex);
    return std::exchange(loop_->reply, std::nullopt);
  }

  /// No force any more, as the newest pose's answer.
  std::optional<SocketMessage> last_words() override {
    const std::lock_guard lock(loop_->mutex);
    loop_->closed = true;  // an answer under way comes too late
    if (!loop_->newest) return std::nullopt;
    const Pose& pose = loop_->newest->pose;
    return zero_wrench(*loop_->newest,
                       pose.position + pose.rotation * (*loop_->use)->loaded.geometry.tool_gc_m);
  }

  void closed() noexcept override {
    const std::lock_guard lock(loop_->mutex);
    loop_->closed = true;
    loop_->wake = nullptr;
  }

 private:
  RemoteLoops& loops_;
  Metrics& metrics_;
  std::shared_ptr<Loop> loop_;
  std::string hello_;
};

RemoteLoops::RemoteLoops(const ServerLimits& limits, Metrics& metrics)
    : limits_(limits), metrics_(metrics), thread_([this] { run(); }) {}

RemoteLoops::~RemoteLoops() {
  {
    const std::lock_guard lock(mutex_);
    stop_ = true;
  }
  work_.notify_all();
  thread_.join();
}

std::variant<std::shared_ptr<SocketHandler>, Problem> RemoteLoops::open(SceneUse scene,
                                                                        const std::string& id) {
  if (metrics_.loops_now >= limits_.loops)
    return Problem{503, "busy", "there are " + std::to_string(limits_.loops) + " haptic connections already",
                   ""};
  const LoadedScene& loaded = (*scene)->loaded;
  const Vec3& gc = loaded.geometry.tool_gc_m;
  const Pose& start = loaded.scene.start;
  const Quat& q = start.rotation;
  std::string hello =
      dump({{"type", "hello"},
            {"scene", id},
            {"stiffness", loaded.scene.response.stiffness_n_per_m},
            {"watchdog_ms", loaded.scene.control.watchdog_ms},
            {"tool_gc", {gc.x, gc.y, gc.z}},
            {"start", {start.position.x, start.position.y, start.position.z, q.x, q.y, q.z, q.w}}});
  return std::make_shared<Socket>(*this, std::make_shared<Loop>(std::move(scene)), std::move(hello));
}

void RemoteLoops::submit(const std::shared_ptr<Loop>& loop) {
  {
    const std::lock_guard lock(mutex_);
    if (std::exchange(loop->queued, true)) return;  // it will see the newest
    waiting_.push_back(loop);
  }
  work_.notify_one();
}

void RemoteLoops::run() {
  const ForHand for_hand;
  set_nice(kNiceContact);
  set_slice(kSliceContactUs);
  for (;;) {
    std::shared_ptr<Loop> loop;
    {
      std::unique_lock lock(mutex_);
      work_.wait(lock, [&] { return stop_ || !waiting_.empty(); });
      if (stop_) return;
      loop = std::move(waiting_.front());
      waiting_.pop_front();
      loop->queued = false;
    }
    answer(*loop);
  }
}

void RemoteLoops::answer(Loop& loop) {
  std::optional<PoseMessage> pose;
  std::uint32_t skipped = 0;
  {
    const std::lock_guard lock(loop.mutex);
    if (loop.closed) return;
    pose = std::exchange(loop.pose, std::nullopt);
    skipped = std::exchange(loop.skipped, 0u);
  }
  if (!pose) return;
  loop.slot.sample = {loop.count++, pose->pose};
  const Result<void> solved = loop.solve(*pose);
  const double us = std::chrono::duration<double, std::micro>(Clock::now() - pose->arrived).count();
  {
    const std::lock_guard lock(loop.mutex);
    if (loop.closed) return;
    if (std::exchange(loop.reply, std::nullopt)) skipped += loop.reply_for;  // not sent in time
  }
  ++metrics_.loop_poses;
  metrics_.loop_s.add(us / 1e6);

  SocketMessage message;
  const Contacts& contacts = loop.slot.contacts;
  const ContactResponse& response = loop.slot.response;
  const LoadedScene& loaded = (*loop.use)->loaded;
  const double stiffness = loaded.scene.response.stiffness_n_per_m;
  // Also where the tool is too far away for the lattice.
  const Vec3 gc = pose->pose.position + pose->pose.rotation * loaded.geometry.tool_gc_m;
  std::vector<AreaResponse> areas;
  if (!pose->planes) areas = loop.field ? felt_area(response, stiffness) : response.areas;
  if (!solved) {
    ++metrics_.backend_errors;
    message = error_message(Problem{500, "internal", solved.error().sentence, ""});
  } else if (pose->binary) {
    std::string& out = message.head;
    const auto put = [&out](const auto& value) {
      out.append(reinterpret_cast<const char*>(&value), sizeof value);
    };
    const auto put_vector = [&](const Vec3& v) {
      for (int i = 0; i < 3; ++i) put(double{v[i]});
    };
    put_wrench_head(*pose, response.told(), gc, us, skipped,
                    (contacts.contact ? kContact : 0u) | (contacts.truncated ? kTruncated : 0u),
                    static_cast<std::uint32_t>(areas.size()), out);
    for (const AreaResponse& area : areas) {
      put_vector(area.normal);
      put_vector(area.point);
      put(area.depth);
      put(stiffness);
    }
    message.binary = true;
  } else {
    std::string& out = message.head;
    fmt::format_to(
        std::back_inserter(out),
        R"({{"type":"wrench","seq":{},"time":{},"skipped":{},"server_us":{:.1f},"contact":{},"truncated":{},"engine":{},"pairs":{},"gc":{},"force":{},"torque":{},"areas":[)",
        pose->seq, json_text(pose->time), skipped, us, contacts.contact, contacts.truncated,
        *contacts.engine != 0 ? fmt::format("\"{}\"", contacts.engine) : "null", contacts.pairs,
        json_text(gc), json_text(response.told().force), json_text(response.told().torque));
    for (std::size_t i = 0; i < areas.size(); ++i) {
      const AreaResponse& area = areas[i];
      fmt::format_to(std::back_inserter(out),
                     R"({}{{"id":{},"normal":{},"point":{},"depth":{},"force":{},"torque":{}}})",
                     i ? "," : "", area.id, json_text(area.normal), json_text(area.point),
                     json_text(area.depth), json_text(area.force), json_text(area.torque));
    }
    out += "]";
    if (pose->planes) put_planes(loop.result, out);
    if (pose->full) {
      out += ",\"frame\":";
      append_query_line({.number = pose->seq,
                         .total_us = loop.slot.total_us,
                         .batch = std::nullopt,
                         .tick = loop.slot.sample.tick,
                         .area_lists = pose->area_lists,
                         .heights = true},
                        contacts, response, out);
      out.pop_back();  // the line feed
    }
    out += "}";
  }
  std::function<void()> wake;
  {
    const std::lock_guard lock(loop.mutex);
    if (loop.closed) return;
    loop.closed = message.close;
    loop.reply = std::move(message);
    loop.reply_for = skipped + 1;
    wake = loop.wake;
  }
  if (wake) wake();
}

void add_haptic_route(Router& router, SceneStore& store, RemoteLoops& loops) {
  router.add(
      {.method = "GET",
       .pattern = "v1/scenes/*/haptic",
       .socket = [&](const HttpRequest& request) -> std::variant<std::shared_ptr<SocketHandler>, Problem> {
         auto use = store.use(request.segments[2], true);
         if (const auto* problem = std::get_if<Problem>(&use)) return *problem;
         return loops.open(std::move(std::get<SceneUse>(use)), request.segments[2]);
       }});
}

}  // namespace palpate

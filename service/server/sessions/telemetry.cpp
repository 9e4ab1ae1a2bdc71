#include "service/server/sessions/telemetry.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstring>
#include <iterator>
#include <utility>

#include "service/queries/query_json.h"
#include "service/server/http/json_input.h"
#include "service/server/sessions/json_text.h"

namespace palpate {
namespace {

constexpr auto kPeriod = std::chrono::microseconds(16'600);  ///< 60 a second: what a screen shows
constexpr std::size_t kHeadBytes = 240, kDroppedAt = 204;    ///< docs/SERVICE.md

template <class T>
void put(std::string& out, const T& value) {
  static_assert(std::is_arithmetic_v<T>);
  out.append(reinterpret_cast<const char*>(&value), sizeof value);
}
void put(std::string& out, const Vec3& v) {
  for (int i = 0; i < 3; ++i) put(out, double{v[i]});
}
void put(std::string& out, const Pose& pose) {
  put(out, pose.position);
  for (const double q : {pose.rotation.x, pose.rotation.y, pose.rotation.z, pose.rotation.w}) put(out, q);
}
void put(std::string& out, const std::vector<std::uint32_t>& list) {
  out.append(reinterpret_cast<const char*>(list.data()), list.size() * sizeof(std::uint32_t));
}

std::string pose_text(const Pose& pose) {
  const Quat& q = pose.rotation;
  return fmt::format("[{},{},{},{},{},{},{}]", json_text(pose.position.x), json_text(pose.position.y),
                     json_text(pose.position.z), json_text(q.x), json_text(q.y), json_text(q.z),
                     json_text(q.w));
}

void append_area(const ContactArea& area, const AreaResponse& response, std::string& out) {
  for (const std::size_t count : {std::size_t{area.id}, std::size_t{response.flags}, area.zones.size(),
                                  area.static_ids.size(), area.mobile_ids.size(), std::size_t{area.rays}})
    put(out, static_cast<std::uint32_t>(count));
  put(out, response.normal);
  put(out, response.depth);
  put(out, response.point);
  put(out, response.force);
  put(out, response.torque);
  put(out, response.max_depth);
  for (const auto& zone : area.zones) put(out, static_cast<std::uint32_t>(zone.size()));
  for (const auto& zone : area.zones) put(out, zone);
  put(out, area.mobile_ids);
}

}  // namespace

Result<void> Telemetry::on_frame(const FrameRecord& frame) {
  frame_us_ = frame.total_us;
  metrics_.session_frame_s.add(frame.total_us / 1e6);
  for (const auto& time : frame.contacts.times)
    metrics_.add_stage(frame.contacts.engine, time.stage, time.us);
  // A frame for each message is enough; making more would cost as much as the frames themselves.
  const auto now = Clock::now();
  if (now - last_frame_ >= kPeriod * 3 / 4 && viewers() > 0) {
    last_frame_ = now;
    const Contacts& contacts = frame.contacts;
    frame_json_.clear();
    append_query_line({.number = static_cast<std::uint64_t>(std::max<std::int64_t>(frame.tick, 0)),
                       .total_us = frame.total_us,
                       .batch = std::nullopt,
                       .tick = frame.tick,
                       .heights = true},
                      contacts, frame.response, frame_json_);
    frame_json_.pop_back();  // the line feed
    frame_pose_ = frame.pose;
    truncated_ = contacts.truncated;
    frame_binary_.clear();
    std::size_t i = 0;
    for (const auto* list :
         {&contacts.cst, &contacts.bst, &contacts.cmt, &contacts.bmt, &contacts.imt, &contacts.est}) {
      counts_[i++] = static_cast<std::uint32_t>(list->size());
      put(frame_binary_, *list);
    }
    put(frame_binary_, frame.pose);
    const std::size_t areas = std::min(contacts.areas.size(), frame.response.areas.size());
    counts_[6] = static_cast<std::uint32_t>(areas);
    for (std::size_t a = 0; a < areas; ++a)
      append_area(contacts.areas[a], frame.response.areas[a], frame_binary_);
  }
  return then_ ? then_->on_frame(frame) : Result<void>();
}

Result<void> Telemetry::on_tick(const TickRecord& tick) {
  tick_ = tick;
  lateness_max_us_ = std::max(lateness_max_us_, double{tick.lateness_us});
  ++metrics_.session_ticks;
  metrics_.session_missed_ticks += tick.missed_ticks - missed_counted_;
  missed_counted_ = tick.missed_ticks;
  metrics_.lateness_s.add(tick.lateness_us / 1e6);
  if (tick.result_age_ticks >= 0) metrics_.result_age_s.add(tick.result_age_ticks / 1e3);
  {
    const std::lock_guard lock(mutex_);
    shown_ = tick;
    if (tick.result_age_ticks >= 0) ages_.add(tick.result_age_ticks);
    lateness_ns_.add(static_cast<std::int64_t>(tick.lateness_us * 1000));
  }
  const auto now = Clock::now();
  if (now - last_ >= kPeriod) {
    last_ = now;
    publish();
  }
  return then_ ? then_->on_tick(tick) : Result<void>();
}

void Telemetry::publish() {
  std::shared_ptr<TelemetryMessage> message;
  if (viewers() > 0) {
    const TickRecord& t = tick_;
    const bool framed = !frame_json_.empty();
    message = std::make_shared<TelemetryMessage>();
    message->seq = ++seq_;
    fmt::format_to(std::back_inserter(message->json),
                   ",\"tick\":{},\"time_s\":{},\"pose\":{},\"force\":{},\"torque\":{},\"response_force\":{},"
                   "\"response_torque\":{},\"result_age_ticks\":{},"
                   "\"contact\":{},\"stage\":{},\"lateness_us\":{},\"lateness_max_us\":{},\"missed_ticks\":{}"
                   ",\"frame_us\":{},\"paused\":{},\"frame\":{},\"frame_pose\":{}}}",
                   t.tick, json_text(t.time_s), pose_text(t.pose), json_text(t.sent.force),
                   json_text(t.sent.torque), json_text(t.response.force), json_text(t.response.torque),
                   t.result_age_ticks, t.contact, t.stage, t.lateness_us, json_text(lateness_max_us_),
                   t.missed_ticks, json_text(frame_us_), t.paused, framed ? frame_json_ : "null",
                   framed ? pose_text(frame_pose_) : "null");
    std::string& out = message->binary;
    out = "PTEL";
    put(out, std::uint16_t{1});
    put(out, static_cast<std::uint16_t>((t.contact ? 1 : 0) | (framed ? 2 : 0) |
                                        (framed && truncated_ ? 4 : 0) | (t.paused ? 8 : 0)));
    put(out, message->seq);
    put(out, t.tick);
    put(out, t.time_s);
    put(out, t.pose);
    for (const Vec3& v : {t.sent.force, t.sent.torque, t.response.force, t.response.torque}) put(out, v);
    put(out, float{t.lateness_us});
    put(out, t.result_age_ticks);
    put(out, static_cast<std::uint32_t>(t.missed_ticks));
    put(out, t.stage);
    put(out, static_cast<float>(frame_us_));
    put(out, std::uint32_t{0});  // dropped
    for (const std::uint32_t count : counts_) put(out, framed ? count : std::uint32_t{0});
    put(out, std::uint32_t{0});
    if (framed) out += frame_binary_;
    frame_json_.clear();
    lateness_max_us_ = 0;
  }
  if (message) {
    const std::lock_guard lock(mutex_);
    newest_ = std::move(message);
  }
  wake_all();
}

void Telemetry::wake_all() {
  const std::lock_guard lock(mutex_);
  for (const auto& wake : viewers_) wake();
}

void Telemetry::finish(const std::string& reason) {
  {
    const std::lock_guard lock(mutex_);
    over_ = reason;
  }
  wake_all();
}

std::shared_ptr<void> Telemetry::attach(std::function<void()> wake) {
  const std::lock_guard lock(mutex_);
  const auto place = viewers_.insert(viewers_.end(), std::move(wake));
  return {this, [place](void* self) {
            auto* telemetry = static_cast<Telemetry*>(self);
            const std::lock_guard inner(telemetry->mutex_);
            telemetry->viewers_.erase(place);
          }};
}

std::shared_ptr<const TelemetryMessage> Telemetry::newest() const {
  const std::lock_guard lock(mutex_);
  return newest_;
}

std::optional<std::string> Telemetry::over() const {
  const std::lock_guard lock(mutex_);
  return over_;
}

std::size_t Telemetry::viewers() const {
  const std::lock_guard lock(mutex_);
  return viewers_.size();
}

Telemetry::Punctuality Telemetry::punctuality() const {
  const std::lock_guard lock(mutex_);
  return {ages_.percentile(0.5),
          ages_.percentile(0.99),
          ages_.max(),
          lateness_ns_.percentile(0.5) / 1000,
          lateness_ns_.percentile(0.99) / 1000,
          lateness_ns_.max() / 1000};
}

TickRecord Telemetry::last_tick() const {
  const std::lock_guard lock(mutex_);
  return shown_;
}

namespace {

class Viewer final : public SocketHandler {
 public:
  Viewer(std::shared_ptr<Telemetry> telemetry, std::string hello, bool binary, Metrics& metrics)
      : telemetry_(std::move(telemetry)), hello_(std::move(hello)), binary_(binary), metrics_(metrics) {}
  ~Viewer() override { closed(); }

  void start(std::function<void()> wake) override {
    ++metrics_.viewers_now;
    handle_ = telemetry_->attach(std::move(wake));
  }
  void message(std::string_view, bool) override {}  // viewers have nothing to say

  std::optional<SocketMessage> next() override {
    if (!hello_.empty()) return SocketMessage{std::exchange(hello_, {}), nullptr, false, false};
    if (const auto reason = telemetry_->over())
      return SocketMessage{R"({"type":"bye","reason":")" + *reason + "\"}", nullptr, false, true};
    const auto newest = telemetry_->newest();
    if (!newest || newest->seq == seen_) return std::nullopt;
    if (seen_ > 0) {
      dropped_ += newest->seq - seen_ - 1;
      metrics_.telemetry_dropped += newest->seq - seen_ - 1;
    }
    seen_ = newest->seq;
    ++metrics_.telemetry_sent;
    if (!binary_)
      return SocketMessage{fmt::format("{{\"type\":\"telemetry\",\"seq\":{},\"dropped\":{}", seen_, dropped_),
                           std::shared_ptr<const std::string>(newest, &newest->json), false, false};
    std::string all = newest->binary;
    const auto dropped = static_cast<std::uint32_t>(dropped_);
    std::memcpy(all.data() + kDroppedAt, &dropped, sizeof dropped);
    static_assert(kDroppedAt + 4 + 8 * 4 == kHeadBytes);
    return SocketMessage{std::move(all), nullptr, true, false};
  }

  void closed() noexcept override {
    if (!handle_) return;
    handle_.reset();
    --metrics_.viewers_now;
  }

 private:
  std::shared_ptr<Telemetry> telemetry_;
  std::string hello_;
  bool binary_;
  Metrics& metrics_;
  std::shared_ptr<void> handle_;
  std::uint64_t seen_ = 0, dropped_ = 0;
};

}  // namespace

std::shared_ptr<SocketHandler> make_viewer(std::shared_ptr<Telemetry> telemetry, std::string hello,
                                           bool binary, Metrics& metrics) {
  return std::make_shared<Viewer>(std::move(telemetry), std::move(hello), binary, metrics);
}

}  // namespace palpate

#include "driver/inverse3/message.h"

#include <array>
#include <cmath>
#include <nlohmann/json.hpp>

#include "driver/limits.h"

namespace palpate::inverse3 {
namespace {

using Json = nlohmann::json;

constexpr std::array kGripLists{"verse_grip", "wireless_verse_grip"};
constexpr double kUnit = 1e-2;  // the grip's quaternion comes from 16-bit numbers; beyond this it is none

Json parsed(std::string_view text) { return Json::parse(text.begin(), text.end(), nullptr, false); }

/// The member, or null: also where `from` is no object.
const Json& member(const Json& from, const char* key) {
  static const Json none;
  const auto found = from.is_object() ? from.find(key) : from.end();
  return from.is_object() && found != from.end() ? *found : none;
}

std::string id_of(const Json& device) {
  const Json& id = member(device, "device_id");
  return id.is_string() ? id.get<std::string>() : std::string();
}

const Json& device(const Json& message, const char* list, const std::string& id) {
  static const Json none;
  const Json& devices = member(message, list);
  if (!devices.is_array()) return none;
  for (const Json& one : devices)
    if (id_of(one) == id) return one;
  return none;
}

std::optional<double> number(const Json& from, const char* key) {
  const Json& value = member(from, key);
  if (!value.is_number()) return std::nullopt;
  const auto is = value.get<double>();
  return std::isfinite(is) ? std::optional(is) : std::nullopt;
}

std::optional<Vec3> vector(const Json& from) {
  const auto x = number(from, "x"), y = number(from, "y"), z = number(from, "z");
  if (!x || !y || !z) return std::nullopt;
  return Vec3(*x, *y, *z);
}

std::optional<Quat> orientation(const Json& from) {
  const auto w = number(from, "w");
  const auto v = vector(from);
  if (!w || !v) return std::nullopt;
  const Quat q(*w, v->x, v->y, v->z);
  const double size = glm::length(q);
  if (!(std::abs(size - 1) <= kUnit)) return std::nullopt;
  return q / size;
}

/// A grip has one button, or an object of named ones.
std::uint32_t buttons(const Json& state) {
  std::uint32_t pressed = 0;
  const Json& one = member(state, "button");
  if (one.is_boolean() && one.get<bool>()) pressed |= 1;
  const Json& named = member(state, "buttons");
  std::uint32_t bit = 1;
  for (const char* name : {"a", "b", "c"}) {
    const Json& is = member(named, name);
    if (is.is_boolean() && is.get<bool>()) pressed |= bit;
    bit *= 2;
  }
  return pressed;
}

/// Whatever the service doesn't say is taken to be well.
bool usable(const Json& status) {
  for (const char* key : {"ready", "power_supply", "calibrated"}) {
    const Json& is = member(status, key);
    if (is.is_boolean() && !is.get<bool>()) return false;
  }
  return true;
}

}  // namespace

Result<Session> read_inventory(std::string_view text) {
  const Json message = parsed(text);
  const Json& arms = member(message, "inverse3");
  if (!arms.is_array())
    return Error{ErrorCode::kNoDevice, "the service's first message is no list of devices"};
  Session session;
  if (!arms.empty()) session.arm = id_of(arms.front());
  if (session.arm.empty()) return Error{ErrorCode::kNoDevice, "the service knows of no Inverse3"};
  for (const char* list : kGripLists) {
    const Json& grips = member(message, list);
    if (!session.grip.empty() || !grips.is_array() || grips.empty()) continue;
    session.grip = id_of(grips.front());
    session.grip_list = list;
  }
  if (member(message, "session_id").is_null()) session.force_key = "values";
  return session;
}

std::optional<State> read_state(std::string_view text, const Session& session) {
  const Json message = parsed(text);
  const Json& arm = device(message, "inverse3", session.arm);
  const auto cursor = vector(member(member(arm, "state"), "cursor_position"));
  if (!cursor) return std::nullopt;
  State state{.cursor = *cursor, .usable = usable(member(arm, "status"))};
  if (session.grip.empty()) return state;
  const Json& grip = member(device(message, session.grip_list.c_str(), session.grip), "state");
  state.orientation = orientation(member(grip, "orientation"));
  state.buttons = buttons(grip);
  return state;
}

std::string force_message(const Session& session, const Vec3& force) {
  const Vec3 sent = finite(force) ? force : Vec3(0);
  Json command{{session.force_key, {{"x", sent.x}, {"y", sent.y}, {"z", sent.z}}}};
  Json arm{{"device_id", session.arm}, {"commands", {{"set_cursor_force", std::move(command)}}}};
  return Json{{"inverse3", Json::array({std::move(arm)})}}.dump();
}

}  // namespace palpate::inverse3

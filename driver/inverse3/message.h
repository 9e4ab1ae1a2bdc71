#pragma once
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>

#include "model/lattice/pose.h"
#include "model/result.h"

namespace palpate::inverse3 {

/// Which arm and which grip a session uses, and how its service spells a force. From the inventory that the
/// service sends when a client connects.
struct Session {
  std::string arm;                   ///< device_id of the first Inverse3
  std::string grip;                  ///< device_id of the first grip; empty: none, so the tool doesn't turn
  std::string grip_list;             ///< the list that the grip is in: "verse_grip" or "wireless_verse_grip"
  const char* force_key = "vector";  ///< "vector" from service 3.5 on, "values" before
};

/// What a message says of a session's devices.
struct State {
  Vec3 cursor{0};                     ///< place of the handle, m, the arm's own frame
  std::optional<Quat> orientation{};  ///< of the grip, the same frame; unit length
  std::uint32_t buttons = 0;          ///< bit 0: a or the only one, bit 1: b, bit 2: c
  bool usable = true;                 ///< the service says that the arm is ready, powered and calibrated
};

/// The session that an inventory allows. Errors: kNoDevice where it lists no Inverse3 or is no inventory.
Result<Session> read_inventory(std::string_view text);

/// A session's state in a message of the service; the inventory has it, too. Nothing where the message
/// isn't JSON, lacks the arm, or has a number that isn't one. A grip that is missing leaves the orientation
/// out.
std::optional<State> read_state(std::string_view text, const Session& session);

/// The message that exerts a force, N, in the arm's frame, once. Each such message is answered with a state.
std::string force_message(const Session& session, const Vec3& force);

}  // namespace palpate::inverse3

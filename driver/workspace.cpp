#include "driver/workspace.h"

namespace palpate {

Workspace::Workspace(const WorkspaceSettings& settings, const Pose& start) noexcept
    : settings_(settings), tool_(start.position) {}

Vec3 Workspace::position(const Vec3& device, std::uint32_t buttons) noexcept {
  clutched_ = (buttons & settings_.clutch_buttons) != 0;
  if (!held_ || clutched_) {
    hand_anchor_ = device;
    tool_anchor_ =
        !held_ && settings_.offset_m ? *settings_.offset_m + settings_.scale * world(device) : tool_;
    held_ = true;
  }
  tool_ = tool_anchor_ + settings_.scale * world(device - hand_anchor_);
  return tool_;
}

Vec3 Workspace::world(const Vec3& device) const noexcept {
  Vec3 turned(0);
  for (int i = 0; i < 3; ++i)
    for (int j = 0; j < 3; ++j)
      turned[i] += settings_.axes[static_cast<std::size_t>(i)][static_cast<std::size_t>(j)] * device[j];
  return turned;
}

Vec3 Workspace::device(const Vec3& world) const noexcept {
  Vec3 turned(0);
  for (int i = 0; i < 3; ++i)
    for (int j = 0; j < 3; ++j)
      turned[j] += settings_.axes[static_cast<std::size_t>(i)][static_cast<std::size_t>(j)] * world[i];
  return turned;
}

}  // namespace palpate

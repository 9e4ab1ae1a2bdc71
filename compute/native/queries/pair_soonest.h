#pragma once
#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <span>

#include "compute/native/queries/pair_gap.h"
#include "compute/native/queries/pair_traversal.h"

namespace palpate::native {

/// What may be met soonest. A box or a triangle that the screw carries on goes along a fixed direction n, in
/// time δ, no further than δ v·n + ½ δ² a: v is where it goes now, and a, how much that can turn, is the
/// angle a time times the speed across the axis, which a screw keeps.
struct PairSearch::Timed {
  static constexpr bool kMoves = true, kNearestFirst = true;
  const PairSearch& search;
  Vec axis, velocity, origin;
  double angle, time;                   ///< the soonest so far
  double fastest;                       ///< speed of the run's fastest point, at most
  double reach = 0, reach_squared = 0;  ///< how far that one gets in `time`, and a little
  FreeTime out{};
  Vec way{};       ///< from the tool to the mock-up, of length 1: between the pair that is met soonest so far
  double top = 0;  ///< of what is looked at, along it
  double closed = 0;                   ///< how far that gets along it in `time`, and a little
  bool aimed = false, turned = false;  ///< whether there are these, and a way
  /// A direction, and how high along it what is looked at gets in `time`.
  struct Reach {
    Vec way;
    double most;
  };
  std::array<Reach, 2> ahead{};  ///< along its normal and against it, of a single triangle
  std::size_t ahead_count = 0;
  /// How a triangle goes on.
  struct Carried {
    std::array<Vec, 3> speeds;       ///< of its corners
    double faster = 0, turning = 0;  ///< the most of them, and of what of them is across the axis
    Vec normal{};                    ///< of length 1, where it is `flat`: of a sliver it is rough
    bool flat = false;
    /// How far any of it may get along a direction in a time; not below 0.
    double gets(const Vec& n, double time, double angle) const {
      const double along = std::max({dot(n, speeds[0]), dot(n, speeds[1]), dot(n, speeds[2])});
      return std::max(time * along + 0.5 * time * time * angle * turning, 0.0);
    }
  };
  std::array<Carried, kLanes> all_carried{};  ///< of the run's
  unsigned known_carried = 0;                 ///< which of them
  const Carried* carried = nullptr;           ///< of the one that is looked at

  void set(double sooner) {
    time = sooner;
    reach = fastest * time + kMotionSlack + 1;
    reach_squared = reach * reach * (1 + 0x1p-40) + 1;
  }
  Vec speed_at(const Vec& p) const { return velocity + cross(axis, p - origin) * angle; }
  double across(const Vec& v) const { return length(v - axis * dot(axis, v)); }

  double within_steps() const { return reach; }
  bool within(double room) const { return room <= reach; }
  bool near(double squared) const { return squared <= reach_squared; }
  /// How far what lies in a box may get along a direction in `time`.
  double gets(const Vec& n, const BoxOf& tool) const {
    Vec centre, half;
    for (std::size_t k = 0; k < 3; ++k) {
      centre[k] = 0.5 * (tool.low[k] + tool.high[k]);
      half[k] = 0.5 * (tool.high[k] - tool.low[k]);
    }
    const Vec v = speed_at(centre), across_axis = cross(n, axis);
    const double swing = angle * length(half);
    const double along =
        dot(v, n) + angle * (std::abs(across_axis[0]) * half[0] + std::abs(across_axis[1]) * half[1] +
                             std::abs(across_axis[2]) * half[2]);
    return std::min(time * (length(v) + swing),
                    time * along + 0.5 * time * time * angle * (across(v) + swing));
  }
  bool keep(double squared, const BoxOf& tool, const BoxOf& mockup) const {
    if (!near(squared)) return false;
    if (aimed && lowest(way, mockup) - top > closed) return false;
    for (std::size_t i = 0; i < ahead_count; ++i)
      if (lowest(ahead[i].way, mockup) > ahead[i].most) return false;
    const double distance = std::sqrt(squared), need = distance - kMotionSlack - 1;
    if (need <= 0) return true;
    Vec n;
    for (std::size_t k = 0; k < 3; ++k)
      n[k] = (std::max(mockup.low[k] - tool.high[k], 0.0) - std::max(tool.low[k] - mockup.high[k], 0.0)) /
             distance;
    return gets(n, tool) >= need;
  }
  void aim(std::span<const Mobile> tool) {
    aimed = turned;
    ahead_count = 0;
    carried = nullptr;
    if (tool.size() == 1) {
      look_ahead(tool.front());
      if (!turned) return;
      top = highest(way, tool.front().corners);
      closed = carried->gets(way, time, angle) + kMotionSlack + 1 + kAlongSlack;
      return;
    }
    if (!turned) return;
    top = -std::numeric_limits<double>::infinity();
    for (const Mobile& m : tool) top = std::max(top, highest(way, m.corners));
    closed = std::max(gets(way, search.run_box_), 0.0) + kMotionSlack + 1 + kAlongSlack;
  }
  /// What lies before and behind a triangle is told apart best along its normal, however slowly that moves.
  void look_ahead(const Mobile& m) {
    const auto place = static_cast<std::size_t>(&m - search.mobiles_.data());
    Carried& found = all_carried[place];
    if ((known_carried >> place & 1) == 0) {
      known_carried |= 1u << place;
      const Vec a{m.corners[0], m.corners[1], m.corners[2]}, b{m.corners[3], m.corners[4], m.corners[5]},
          c{m.corners[6], m.corners[7], m.corners[8]}, normal = cross(b - a, c - a);
      found = {.speeds = {speed_at(a), speed_at(b), speed_at(c)}};
      for (const Vec& v : found.speeds) {
        found.faster = std::max(found.faster, length(v));
        found.turning = std::max(found.turning, across(v));
      }
      const double size = length(normal);
      found.flat = size > 0;
      if (found.flat) found.normal = normal * (1 / size);
    }
    carried = &found;
    if (!found.flat) return;
    for (const double side : {1.0, -1.0}) {
      const Vec n = found.normal * side;
      ahead[ahead_count++] = {
          n, highest(n, m.corners) + found.gets(n, time, angle) + kMotionSlack + 1 + kAlongSlack};
    }
  }
  unsigned near_along(const Lanes& corners) const {
    unsigned near = aimed ? up_to(way, corners, top + closed) : ~0u;
    for (std::size_t i = 0; i < ahead_count && near != 0; ++i)
      near &= up_to(ahead[i].way, corners, ahead[i].most);
    return near;
  }
  /// Of the triangle that is looked at, in `time`.
  PairMotion motion() const {
    return {carried->speeds, time, 0.5 * time * time * angle * carried->turning, kMotionSlack + 1};
  }
  void met(std::uint32_t s, std::uint32_t m) {
    out = {.time = 0, .blocked = true, .steps = 0, .static_id = s, .mobile_id = m};
    set(0);
  }
  bool wants_distances() const { return true; }
  void pair(std::uint32_t s_id, std::uint32_t m_id, const exact::Corners& m_corners, double distance,
            double error, std::size_t feature) {
    const double sure = distance - error;
    if (sure - kMotionSlack > carried->faster * time) return;
    const exact::Corners s_corners = search.fixed(s_id);
    const std::array<Vec, 3> s{vec(s_corners[0]), vec(s_corners[1]), vec(s_corners[2])},
        m{vec(m_corners[0]), vec(m_corners[1]), vec(m_corners[2])};
    const NearestPoints near = nearest_points(s, m, feature);
    double sooner = 0;
    Vec found{};
    if (near.squared > 0) {
      found = (near.on_s - near.on_m) * (1 / std::sqrt(near.squared));
      double room = std::numeric_limits<double>::infinity(), front = -room, along = -room;
      for (std::size_t c = 0; c < 3; ++c) {
        room = std::min(room, dot(found, s[c] - near.on_m));
        front = std::max(front, dot(found, m[c] - near.on_m));
        along = std::max(along, dot(found, carried->speeds[c]));
      }
      // Along a direction there is so much room between them, however far it is from the nearest points'.
      const double need = room - front - kRoomError - kMotionSlack;
      if (need > 0) {
        const double a = angle * carried->turning;
        const double under = std::sqrt(along * along + 2 * a * need);
        sooner = a > 0       ? (along > 0 ? 2 * need / (along + under) : (under - along) / a)
                 : along > 0 ? need / along
                             : std::numeric_limits<double>::infinity();
        sooner *= 1 - 0x1p-40;
      }
    }
    sooner = std::max(sooner, (sure - kMotionSlack) / carried->faster * (1 - 0x1p-40));
    // They are no further apart than this.
    auto steps = static_cast<std::int32_t>(std::max(distance + error, 0.0));
    if (sooner * carried->faster < error) {  // of large triangles doubles don't tell what is left
      steps = exact::gap(s_corners, m_corners, INT32_MAX).steps;
      sooner = std::max(sooner, (steps - kMotionSlack) / carried->faster * (1 - 0x1p-40));
    }
    if (sooner >= time) return;
    out = {.time = sooner, .blocked = true, .steps = steps, .static_id = s_id, .mobile_id = m_id};
    set(sooner);
    way = found;
    turned = sooner > 0;
    aimed = false;
  }
};

}  // namespace palpate::native

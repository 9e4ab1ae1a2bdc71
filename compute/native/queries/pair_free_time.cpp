#include "compute/native/queries/pair_traversal.h"

namespace palpate::native {

/// What may be met soonest. A box or a triangle that the screw carries on goes along a fixed direction n, in
/// time δ, no further than δ v·n + ½ δ² a: v is where it goes now, and a, how much that can turn, is the
/// angle a time times the speed across the axis, which a screw keeps.
struct PairSearch::Timed {
  static constexpr bool kNearestFirst = true;
  const PairSearch& search;
  Vec axis, velocity, origin;
  double angle, time;                   ///< the soonest so far
  double fastest;                       ///< speed of the tool's fastest point, at most
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
  static bool known() { return false; }
  static double room_along(const Vec&) { return 0; }
  void aim(std::span<const Mobile> tool) {
    aimed = turned;
    ahead_count = 0;
    if (tool.size() == 1) look_ahead(tool.front());
    if (!turned) return;
    top = -std::numeric_limits<double>::infinity();
    BoxOf box = tool.front().box;
    for (const Mobile& m : tool) {
      top = std::max(top, highest(way, m.corners));
      for (std::size_t k = 0; k < 3; ++k) {
        box.low[k] = std::min(box.low[k], m.box.low[k]);
        box.high[k] = std::max(box.high[k], m.box.high[k]);
      }
    }
    closed = std::max(gets(way, box), 0.0) + kMotionSlack + 1 + kAlongSlack;
  }
  /// What lies before and behind a triangle is told apart best along its normal, however slowly that moves.
  void look_ahead(const Mobile& m) {
    const Vec a{m.corners[0], m.corners[1], m.corners[2]}, b{m.corners[3], m.corners[4], m.corners[5]},
        c{m.corners[6], m.corners[7], m.corners[8]}, normal = cross(b - a, c - a);
    const double size = length(normal);
    if (!(size > 0)) return;
    for (const double side : {1.0, -1.0}) {
      const Vec n = normal * (side / size);
      ahead[ahead_count++] = {
          n, highest(n, m.corners) + std::max(gets(n, m.box), 0.0) + kMotionSlack + 1 + kAlongSlack};
    }
  }
  unsigned near_along(const Lanes& corners) const {
    unsigned near = aimed ? up_to(way, corners, top + closed) : ~0u;
    for (std::size_t i = 0; i < ahead_count && near != 0; ++i)
      near &= up_to(ahead[i].way, corners, ahead[i].most);
    return near;
  }
  void met(std::uint32_t s, std::uint32_t m) {
    out = {.time = 0, .blocked = true, .steps = 0, .static_id = s, .mobile_id = m};
    set(0);
  }
  bool wants_distances() const { return true; }
  void pair(std::uint32_t s_id, std::uint32_t m_id, const exact::Corners& m_corners, double distance,
            double error) {
    const double sure = distance - error;
    if (sure - kMotionSlack > fastest * time) return;
    double sooner = 0;
    Vec found{};
    if (sure > kMotionSlack) {
      const exact::Corners s_corners = search.fixed(s_id);
      const std::array<Vec, 3> s{vec(s_corners[0]), vec(s_corners[1]), vec(s_corners[2])},
          m{vec(m_corners[0]), vec(m_corners[1]), vec(m_corners[2])};
      const NearestPoints near = nearest_points(s, m);
      const Vec n = (near.on_s - near.on_m) * (1 / std::sqrt(near.squared));
      found = n;
      double room = std::numeric_limits<double>::infinity(), front = -room, along = -room, faster = 0,
             turning = 0;
      for (std::size_t c = 0; c < 3; ++c) {
        const Vec v = speed_at(m[c]);
        room = std::min(room, dot(n, s[c] - near.on_m));
        front = std::max(front, dot(n, m[c] - near.on_m));
        along = std::max(along, dot(n, v));
        faster = std::max(faster, length(v));
        turning = std::max(turning, across(v));
      }
      const double need = room - front - error -
                          kMotionSlack;  // along n there is so much room between them, whatever n is worth
      if (need > 0) {
        const double a = angle * turning;
        const double under = std::sqrt(along * along + 2 * a * need);
        sooner = a > 0       ? (along > 0 ? 2 * need / (along + under) : (under - along) / a)
                 : along > 0 ? need / along
                             : std::numeric_limits<double>::infinity();
        sooner *= 1 - 0x1p-40;
      }
      sooner = std::max(sooner, (sure - kMotionSlack) / faster * (1 - 0x1p-40));
    }
    if (sooner >= time) return;
    out = {.time = sooner,
           .blocked = true,
           .steps = static_cast<std::int32_t>(std::max(distance + error, 0.0)),  // they are no further apart
           .static_id = s_id,
           .mobile_id = m_id};
    set(sooner);
    way = found;
    turned = sooner > 0;
    aimed = false;
  }
};

FreeTime PairSearch::free_time(const LatticePose& pose, const Twist& twist, double longest) {
  begin(pose);
  Timed policy{*this, vec(twist.axis), vec(twist.velocity), vec(pose.translation), twist.angle, 0, 0};
  // The tool's points go along the axis as its origin does, and across it by that one's speed and their own
  // turn about it.
  const double along = dot(policy.axis, policy.velocity),
               across = policy.across(policy.velocity) + twist.angle * twist.radius;
  policy.fastest = std::sqrt(along * along + across * across);
  policy.out.time = longest;
  policy.set(longest);
  if (blocking_[0] != kNoTriangle) {
    const exact::Corners m = mobile(blocking_[1]), s = fixed(blocking_[0]);
    if (!(exact::raw_normal(m) == exact::Normal{})) {
      const exact::Box box = exact::box_of(m), other = exact::box_of(s);
      if (gap({vec(box.low), vec(box.high)}, {vec(other.low), vec(other.high)}) >
          0) {  // else it may meet: that is the search's to say
        const NearestPoints d =
            nearest_points({vec(s[0]), vec(s[1]), vec(s[2])}, {vec(m[0]), vec(m[1]), vec(m[2])});
        const double size = std::sqrt(d.squared) + twist.radius;
        policy.pair(blocking_[0], blocking_[1], m, std::sqrt(d.squared),
                    distance_error(std::min(size, 0x1p29), size));
      }
    }
  }
  search(policy);
  if (policy.out.blocked) blocking_ = {policy.out.static_id, policy.out.mobile_id};
  return policy.out;
}

}  // namespace palpate::native

#pragma once
// How PairSearch goes down both bodies' trees, for any policy. Included by the files that have one.
#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <limits>
#include <span>

#include "compute/native/queries/nearest_points.h"
#include "compute/native/queries/pair_search.h"

namespace palpate::native {

constexpr std::uint32_t kWide = kLanes;

inline double largest(const BoxOf& box) {
  return std::max({box.high[0] - box.low[0], box.high[1] - box.low[1], box.high[2] - box.low[2]});
}
inline BoxOf box_at(const TriangleTree::Boxes& boxes, std::size_t i) {
  BoxOf out;
  for (std::size_t k = 0; k < 3; ++k) {
    out.low[k] = boxes.low[k][i];
    out.high[k] = boxes.high[k][i];
  }
  return out;
}

/// The children of node `index` of `level` > 0: how many, and which Boxes they are.
inline std::uint32_t children(const TriangleTree& tree, std::uint32_t level, std::uint32_t index) {
  return std::min(kWide, tree.nodes(level - 1) - kWide * index);
}
inline std::uint32_t group_of(const TriangleTree& tree, std::uint32_t level, std::uint32_t index) {
  return tree.level_begin[level - 1] + index;
}

/// Asks memory for what is looked at soon.
template <class T>
inline void prefetch(const T& what) {
  const char* const at = reinterpret_cast<const char*>(&what);
  for (std::size_t line = 0; line < sizeof what; line += 64) __builtin_prefetch(at + line);
}

inline double gap(const BoxOf& a, const BoxOf& b) {
  double sum = 0;
  for (std::size_t k = 0; k < 3; ++k) {
    const double g = std::max({b.low[k] - a.high[k], a.low[k] - b.high[k], 0.0});
    sum += g * g;
  }
  return sum;
}

/// How deep two boxes that meet are in each other, along the axis where it is least.
template <class Boxes>
inline double overlap(const BoxOf& box, const Boxes& boxes, std::size_t i) {
  double least = std::numeric_limits<double>::infinity();
  for (std::size_t k = 0; k < 3; ++k)
    least = std::min({least, box.high[k] - static_cast<double>(boxes.low[k][i]),
                      static_cast<double>(boxes.high[k][i]) - box.low[k]});
  return least;
}

inline BoxOf box_of(const exact::Corners& t) {
  const exact::Box box = exact::box_of(t);
  return {vec(box.low), vec(box.high)};
}

/// Whether a triangle whose corners are collinear passes through another, as the segment that it is.
inline bool passes_through(const exact::Corners& line, const exact::Corners& t) {
  for (std::size_t e = 0; e < 3; ++e)
    if (line[e] != line[(e + 1) % 3] && exact::segment_crossing(line[e], line[(e + 1) % 3], t) != 0)
      return true;
  return false;
}

/// The lowest place of a box along a direction.
inline double lowest(const Vec& way, const BoxOf& box) {
  double out = 0;
  for (std::size_t k = 0; k < 3; ++k) out += way[k] * (way[k] > 0 ? box.low[k] : box.high[k]);
  return out;
}

/// The highest of a triangle's corners along it.
inline double highest(const Vec& way, const std::array<double, 9>& corners) {
  double out = -std::numeric_limits<double>::infinity();
  for (std::size_t c = 0; c < 9; c += 3)
    out = std::max(out, way[0] * corners[c] + way[1] * corners[c + 1] + way[2] * corners[c + 2]);
  return out;
}

/// A bit for each of eight triangles that does not lie wholly above a place along it.
inline unsigned up_to(const Vec& way, const std::array<std::array<std::int32_t, kLanes>, 9>& corners,
                      double place) {
  std::array<double, kLanes> low{};
  for (std::size_t c = 0; c < 9; c += 3)
    for (std::size_t i = 0; i < kLanes; ++i) {
      const double at = way[0] * corners[c][i] + way[1] * corners[c + 1][i] + way[2] * corners[c + 2][i];
      low[i] = c == 0 ? at : std::min(low[i], at);
    }
  unsigned out = 0;
  for (std::size_t i = 0; i < kLanes; ++i) out |= low[i] <= place ? 1u << i : 0u;
  return out;
}

constexpr unsigned kAllRuns = ~0U;
constexpr std::size_t kFewRuns = 64;    // of the tool: what meets is mostly found among so many (chosen)
constexpr std::size_t kFewBalls = 3;    // of them: what meets is often found among so many (chosen)
constexpr std::size_t kMostAbout = 16;  // chosen
constexpr std::uint32_t kMany = 5;      // of eight, from which on it pays to ask about all at once (chosen)
constexpr double kWorthAStep = 0.05;    // of a sphere's radius or a cell: less room is no step (chosen)
constexpr double kReach = 0.2;          // of both: how far ahead triangles are asked (chosen)
constexpr double kSameTime = 0x1p-40;   // what a sum and a difference of times are off by, and more
constexpr double kAlongSlack = 0x1p-8;  // more than places along a way are off by, steps

/// What holds those of eight spheres that a mask names, at the pose.
inline BoxOf box_of(const RoomField& field, const RoomField::Turn& turn, const EightSpheres& spheres,
                    unsigned mask) {
  BoxOf out;
  out.low.fill(std::numeric_limits<double>::infinity());
  out.high.fill(-std::numeric_limits<double>::infinity());
  for (; mask != 0; mask &= mask - 1) {
    const auto i = static_cast<std::size_t>(std::countr_zero(mask));
    const Vec centre = field.centre(turn, spheres, i);
    const double reach = static_cast<double>(spheres.radius[i]) + turn.slack;
    for (std::size_t k = 0; k < 3; ++k) {
      out.low[k] = std::min(out.low[k], centre[k] - reach);
      out.high[k] = std::max(out.high[k], centre[k] + reach);
    }
  }
  return out;
}

/// Runs of the tool whose spheres come so near that the policy may want them: kept in leads_, or asked about
/// at once, the nearest sphere of each eight first. False: the policy knows enough.
template <class Policy>
bool PairSearch::gather(Policy& policy) {
  leads_.clear();
  const ToolSpheres& spheres = trees_->spheres;
  groups_.clear();
  groups_.push_back({spheres.top(), 0});
  EightFloats squared;
  while (!groups_.empty()) {
    const Group group = groups_.back();
    groups_.pop_back();
    const EightSpheres& eight = spheres.group(group.level, group.number);
    trees_->field.rooms(turn_, eight, squared);
    Lead lead{std::numeric_limits<double>::infinity(), group.number, 0, {}};
    std::array<std::uint32_t, kLanes> order;
    std::uint32_t count = 0;
    for (std::uint32_t i = 0; i < kWide; ++i) {
      double room = trees_->field.room(turn_, squared[i], eight.radius[i]);
      if (policy.within(room) && squared[i] >= RoomField::kFarSquared)
        room = trees_->field.far_room(turn_, eight, i, squared[i]);
      if (policy.within(room) && policy.known())
        room = std::max(room, policy.room_along(trees_->field.centre(turn_, eight, i)) -
                                  static_cast<double>(eight.radius[i]) - turn_.slack);
      lead.rooms[i] = room;
      if (!policy.within(room)) continue;
      lead.mask |= 1u << i;
      lead.room = std::min(lead.room, room);
      std::uint32_t at = count++;
      for (; at > 0 && lead.rooms[order[at - 1]] < room; --at) order[at] = order[at - 1];
      order[at] = i;
    }
    if (count == 0) continue;
    // Eight runs that are asked about one after the other are near the same of the mock-up.
    if (!Policy::kNearestFirst && group.level == std::min(1U, spheres.top()))
      looked_about_ = runs_asked_ > kFewRuns && count >= kMany && runs_.worth_asking() &&
                      look_about(policy, box_of(trees_->field, turn_, eight, lead.mask));
    if (group.level != 0)
      for (std::uint32_t n = 0; n < count; ++n)
        groups_.push_back({group.level - 1, kWide * group.number + order[n]});
    else if (Policy::kNearestFirst)
      leads_.push_back(lead);
    else if (!(++runs_asked_ > kFewRuns && looked_about_ && count >= kMany
                   ? ask(policy, lead, box_of(trees_->field, turn_, eight, lead.mask))
                   : descend(policy, lead)))
      return false;
  }
  return true;
}

/// The groups of eight runs of the mock-up that are near a box: in about_. False: there are many, and each
/// run of the tool finds its own sooner.
template <class Policy>
bool PairSearch::look_about(const Policy& policy, const BoxOf& box) {
  const TriangleTree& mockup = trees_->mockup;
  about_.clear();
  open_.clear();
  open_.push_back({static_cast<std::uint32_t>(mockup.level_begin.size()), 0, 0});
  std::array<double, kLanes> gaps;
  while (!open_.empty()) {
    const Node node = open_.back();
    open_.pop_back();
    if (node.level == 1) {
      if (about_.size() == kMostAbout) return false;
      about_.push_back(node.index);
      continue;
    }
    box_gaps(box, mockup.boxes[group_of(mockup, node.level, node.index)], gaps);
    for (std::uint32_t i = 0; i < children(mockup, node.level, node.index); ++i)
      if (policy.near(gaps[i])) open_.push_back({node.level - 1, kWide * node.index + i, gaps[i]});
  }
  return true;
}

/// What holds a run of the tool at the pose.
inline PairSearch::Around PairSearch::around(std::uint32_t run) const {
  Around out;
  const ToolSpheres& spheres = trees_->spheres;
  if (spheres.top() == 0) return out;  // one run: it has no sphere
  const EightSpheres& eight = spheres.group(1, run / kWide);
  const Vec at = trees_->field.centre(turn_, eight, run % kWide);
  for (std::size_t k = 0; k < 9; ++k) out.centre[k] = at[k % 3];
  const Int3 whole(Vec3(std::floor(at[0] + 0.5), std::floor(at[1] + 0.5), std::floor(at[2] + 0.5)));
  out.point.take({whole, whole, whole});  // within a step of it
  out.radius = static_cast<double>(eight.radius[run % kWide]) + turn_.slack + 1;
  return out;
}

/// Of eight runs of the mock-up those that may matter to a run of the tool in a box: a bit each. By their
/// boxes, by those along their own axes, and by their triangles' planes, for where a shaft is in a hole all
/// boxes about the hole's wall hold the shaft.
template <class Policy>
unsigned PairSearch::near_runs(const Policy& policy, const BoxOf& box, Around& around, std::uint32_t number) {
  const TriangleTree& mockup = trees_->mockup;
  const double reach = around.radius + policy.within_steps(), most = reach + kRoomError;
  std::array<double, kLanes> gaps, turned;
  box_gaps(box, mockup.boxes[group_of(mockup, 1, number)], gaps);
  unsigned out = 0;
  for (std::uint32_t i = 0; i < children(mockup, 1, number); ++i) out |= policy.near(gaps[i]) ? 1u << i : 0u;
  if (out == 0 || reach == std::numeric_limits<double>::infinity()) return out;
  turned_gaps(around.centre, mockup.turned[number], turned);
  for (unsigned left = out; left != 0; left &= left - 1) {
    const auto i = static_cast<std::uint32_t>(std::countr_zero(left));
    const std::uint32_t run = kWide * number + i,
                        count =
                            std::min(kWide, static_cast<std::uint32_t>(mockup.order.size()) - kWide * run);
    bool near = turned[i] <= reach * reach;
    if (near) {
      around.point.s = &trees_->corners[run];
      std::array<double, kLanes> squared;
      rooms(around.point, squared);
      near =
          std::any_of(squared.begin(), squared.begin() + count, [&](double s) { return s <= most * most; });
    }
    if (!near) out &= ~(1u << i);
  }
  return out;
}

/// Asks about a run of the tool, that lies in a box, and what look_about() has found. False: the policy knows
/// enough.
template <class Policy>
bool PairSearch::ask(Policy& policy, const Lead& lead, const BoxOf& box) {
  const TriangleTree& mockup = trees_->mockup;
  Around near = around(lead.run);
  open_.clear();
  for (const std::uint32_t number : about_)
    if (const unsigned runs = near_runs(policy, box, near, number); runs != 0)
      open_.push_back({1, number, 0, runs});
  runs_.count(open_.empty());
  if (open_.empty()) return true;
  pose(policy, lead);
  if (count_ == 0) return true;
  // Those that overlap most first.
  std::array<double, kLanes> gaps;
  for (Node& node : open_) {
    const TriangleTree::Boxes& boxes = mockup.boxes[group_of(mockup, 1, node.index)];
    box_gaps(run_box_, boxes, gaps);
    node.squared = std::numeric_limits<double>::infinity();
    for (unsigned left = node.runs; left != 0; left &= left - 1) {
      const auto i = static_cast<std::size_t>(std::countr_zero(left));
      node.squared = std::min(node.squared, gaps[i] > 0 ? gaps[i] : -overlap(run_box_, boxes, i));
    }
  }
  std::sort(open_.begin(), open_.end(), [](const Node& a, const Node& b) { return a.squared < b.squared; });
  for (const Node& node : open_)
    for (std::size_t i = 0; i < count_; ++i)
      if (!group(policy, mobiles_[i], node.index, node.runs)) return false;
  return true;
}

/// Asks about the triangle that seems to be nearest, going down by the nearest sphere of each eight: whatever
/// is further than what comes of it is left out from the beginning.
template <class Policy>
bool PairSearch::dive(Policy& policy) {
  EightFloats squared;
  std::uint32_t number = 0;
  for (std::uint32_t level = trees_->spheres.top() + 1; level-- > 0;) {
    const EightSpheres& eight = trees_->spheres.group(level, number);
    trees_->field.rooms(turn_, eight, squared);
    std::uint32_t best = 0;
    double least = std::numeric_limits<double>::infinity();
    for (std::uint32_t i = 0; i < kWide; ++i) {
      double room = trees_->field.room(turn_, squared[i], eight.radius[i]);
      if (room < least && squared[i] >= RoomField::kFarSquared)
        room = trees_->field.far_room(turn_, eight, i, squared[i]);
      if (room >= least) continue;
      least = room;
      best = i;
    }
    number = kWide * number + best;
  }
  if (number >= trees_->tool.order.size()) return true;
  Lead lead{0, number / kWide, 1u << number % kWide, {}};
  return descend(policy, lead);
}

/// Shows a policy the pairs that it may want, the tool's runs with the least room first. A policy has
///   within(room): whether what is no nearer than so many steps may matter;
///   near(squared): the same of a square;
///   keep(squared, tool box, mock-up box): whether what is in them, so far apart, may matter;
///   met(static id, mobile id): they meet, and the search is over;
///   pair(…): they are so far apart, but for an error.
template <class Policy>
void PairSearch::search(Policy& policy) {
  if (trees_->tool.order.empty() || trees_->mockup.order.empty()) return;
  balls_ = runs_ = {};
  runs_asked_ = 0;
  if (Policy::kNearestFirst && !dive(policy)) return;
  if (!gather(policy)) return;
  std::sort(leads_.begin(), leads_.end(), [](const Lead& a, const Lead& b) { return a.room < b.room; });
  for (const Lead& lead : leads_) {
    if (!policy.within(lead.room)) return;
    if (!descend(policy, lead)) return;
  }
}

/// Of a run's triangles those that the policy may want, at the pose.
template <class Policy>
void PairSearch::pose(const Policy& policy, const Lead& lead) {
  count_ = 0;
  for (std::uint32_t i = 0; i < kWide; ++i) {
    if ((lead.mask >> i & 1) == 0 || !policy.within(lead.rooms[i])) continue;
    Mobile& m = mobiles_[count_];
    m.id = trees_->tool.order[kWide * lead.run + i];
    m.at = mobile(m.id);
    m.collinear = exact::raw_normal(m.at) == exact::Normal{};
    if (m.collinear && !Policy::kMoves) continue;  // at this pose in no pair, but perhaps at the next
    // What meets is mostly found before this pays; what is nearest, or met soonest, sooner without it.
    if (!Policy::kNearestFirst && runs_asked_ > kFewBalls && lead.rooms[i] < trees_->field.detail_steps() &&
        balls_.worth_asking()) {
      const bool beyond = trees_->field.all_beyond(m.at, policy.within_steps());
      balls_.count(beyond);
      if (beyond) continue;
    }
    m.box = box_of(m.at);
    for (std::size_t c = 0; c < 3; ++c)
      for (std::size_t k = 0; k < 3; ++k) m.corners[3 * c + k] = m.at[c][static_cast<int>(k)];
    if (count_ == 0) run_box_ = m.box;
    for (std::size_t k = 0; k < 3; ++k) {
      run_box_.low[k] = std::min(run_box_.low[k], m.box.low[k]);
      run_box_.high[k] = std::max(run_box_.high[k], m.box.high[k]);
    }
    ++count_;
  }
}

/// From the mock-up's root to its runs near a run of the tool. False: the policy knows enough.
template <class Policy>
bool PairSearch::descend(Policy& policy, const Lead& lead) {
  pose(policy, lead);
  if (count_ == 0) return true;
  const TriangleTree& mockup = trees_->mockup;
  open_.clear();
  open_.push_back({static_cast<std::uint32_t>(mockup.level_begin.size()), 0, 0});
  std::array<double, kLanes> gaps;
  std::array<std::uint32_t, kLanes> order;
  while (!open_.empty()) {
    const Node node = open_.back();
    open_.pop_back();
    if (!policy.near(node.squared)) continue;
    if (node.level == 1) {
      for (std::size_t i = 0; i < count_; ++i)
        if (!group(policy, mobiles_[i], node.index, kAllRuns)) return false;
      continue;
    }
    const TriangleTree::Boxes& boxes = mockup.boxes[group_of(mockup, node.level, node.index)];
    box_gaps(run_box_, boxes, gaps);
    policy.aim({mobiles_.data(), count_});
    const std::uint32_t count =
        sorted(policy, run_box_, boxes, gaps, children(mockup, node.level, node.index), order);
    for (std::uint32_t n = 0; n < count; ++n) {
      const std::uint32_t child = kWide * node.index + order[n];
      prefetch(mockup.boxes[group_of(mockup, node.level - 1, child)]);
      open_.push_back({node.level - 1, child, gaps[order[n]]});
    }
  }
  return true;
}

/// Of eight boxes those that may matter, the furthest first, so that the nearest, or the two that overlap
/// most, are last.
template <class Policy>
std::uint32_t PairSearch::sorted(const Policy& policy, const BoxOf& box, const TriangleTree::Boxes& boxes,
                                 const std::array<double, kLanes>& gaps, std::uint32_t all,
                                 std::array<std::uint32_t, kLanes>& order) {
  std::array<double, kLanes> rank;
  std::uint32_t count = 0;
  for (std::uint32_t i = 0; i < all; ++i) {
    if (!policy.near(gaps[i]) || !policy.keep(gaps[i], box, box_at(boxes, i))) continue;
    rank[i] = gaps[i] > 0 ? gaps[i] : -overlap(box, boxes, i);
    std::uint32_t at = count++;
    for (; at > 0 && rank[order[at - 1]] < rank[i]; --at) order[at] = order[at - 1];
    order[at] = i;
  }
  return count;
}

/// A triangle and those of eight runs that `runs` has a bit for.
template <class Policy>
bool PairSearch::group(Policy& policy, const Mobile& m, std::uint32_t number, unsigned runs) {
  const TriangleTree& mockup = trees_->mockup;
  const TriangleTree::Boxes& boxes = mockup.boxes[group_of(mockup, 1, number)];
  const std::uint32_t all = children(mockup, 1, number);
  std::array<double, kLanes> gaps, turned;
  std::array<std::uint32_t, kLanes> order;
  box_gaps(m.box, boxes, gaps);
  bool any = false;
  for (std::uint32_t i = 0; i < all; ++i) any = any || ((runs >> i & 1) != 0 && policy.near(gaps[i]));
  if (!any) return true;
  policy.aim({&m, 1});
  std::uint32_t count = sorted(policy, m.box, boxes, gaps, all, order);
  if (count == 0) return true;
  turned_gaps(m.corners, mockup.turned[number], turned);
  for (std::uint32_t n = 0; n < count; ++n)
    if (policy.near(turned[order[n]])) {
      prefetch(trees_->boxes[kWide * number + order[n]]);
      prefetch(trees_->corners[kWide * number + order[n]]);
    }
  while (count-- > 0)
    if ((runs >> order[count] & 1) != 0 && policy.near(std::max(gaps[order[count]], turned[order[count]])) &&
        !leaf(policy, m, kWide * number + order[count], box_at(boxes, order[count])))
      return false;
  return true;
}

template <class Policy>
bool PairSearch::leaf(Policy& policy, const Mobile& m, std::uint32_t run, const BoxOf& run_box) {
  const std::uint32_t count =
      std::min(kWide, static_cast<std::uint32_t>(trees_->mockup.order.size()) - kWide * run);
  std::array<double, kLanes> gaps;
  box_gaps(m.box, trees_->boxes[run], gaps);
  unsigned mask = 0, crossing = 0;
  for (std::uint32_t lane = 0; lane < count; ++lane) {
    if (policy.near(gaps[lane])) mask |= 1u << lane;
    if (gaps[lane] == 0) crossing |= 1u << lane;
  }
  if (mask == 0) return true;
  const auto& corners = trees_->corners[run];
  const std::uint32_t* const ids = &trees_->mockup.order[kWide * run];
  PairLanes lanes{.s = &corners};
  // Those that a way or a plane tells apart are left out.
  const auto narrow = [&] {
    mask &= policy.near_along(corners);
    if (mask == 0) return;
    lanes.take(m.at);
    if constexpr (Policy::kMoves) {
      mask &= may_meet(lanes, policy.motion());
    } else {
      std::array<double, kLanes> squared;
      rooms(lanes, squared);
      for (std::uint32_t lane = 0; lane < count; ++lane) {
        const double room = std::max(std::sqrt(squared[lane]) - kRoomError, 0.0);
        if (!policy.near(room * room)) mask &= ~(1u << lane);
      }
    }
  };
  if constexpr (Policy::kNearestFirst) {
    narrow();
    if (mask == 0) return true;
    crossing &= mask;
  }
  // Pairs that meet first: their corners and edges may be far from each other.
  if (crossing != 0) {
    std::array<PairFilter::Verdict, PairFilter::kLanes> verdicts{};
    filter_.put(corners, m.at);
    filter_.judge(verdicts);
    for (std::uint32_t lane = 0; lane < count; ++lane) {
      if ((crossing >> lane & 1) == 0 || verdicts[lane] == PairFilter::kApart) continue;
      if (verdicts[lane] == PairFilter::kUnknown &&
          !(m.collinear ? passes_through(m.at, fixed(ids[lane]))
                        : exact::triangles_meet(fixed(ids[lane]), m.at, exact::raw_normal(m.at))))
        continue;
      policy.met(ids[lane], m.id);
      return false;
    }
  }
  if (!policy.wants_distances()) return true;
  if constexpr (!Policy::kNearestFirst) {
    narrow();
    if (mask == 0) return true;
  }
  PairDistances found;
  distances(lanes, found);
  // No edge is longer than twice its box's longest side.
  const double edge = 2 * largest(m.box), reach = edge + 2 * largest(run_box);
  for (; mask != 0; mask &= mask - 1) {
    const auto lane = static_cast<std::size_t>(std::countr_zero(mask));
    const double distance = std::sqrt(found.squared[lane]);
    policy.pair(ids[lane], m.id, m.at, distance,
                distance_error(std::min(edge, 2 * largest(run_box)), reach + distance),
                static_cast<std::size_t>(found.feature[lane]));
  }
  return true;
}

}  // namespace palpate::native

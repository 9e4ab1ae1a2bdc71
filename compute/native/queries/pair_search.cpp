#include "compute/native/queries/pair_search.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <limits>
#include <span>

#include "compute/native/queries/nearest_points.h"
#include "compute/native/queries/pair_gap.h"

namespace palpate::native {
namespace {

constexpr std::uint32_t kWide = kLanes;

double largest(const BoxOf& box) {
  return std::max({box.high[0] - box.low[0], box.high[1] - box.low[1], box.high[2] - box.low[2]});
}
BoxOf box_at(const TriangleTree::Boxes& boxes, std::size_t i) {
  BoxOf out;
  for (std::size_t k = 0; k < 3; ++k) {
    out.low[k] = boxes.low[k][i];
    out.high[k] = boxes.high[k][i];
  }
  return out;
}

/// The children of node `index` of `level` > 0: how many, and which Boxes they are.
std::uint32_t children(const TriangleTree& tree, std::uint32_t level, std::uint32_t index) {
  return std::min(kWide, tree.nodes(level - 1) - kWide * index);
}
std::uint32_t group_of(const TriangleTree& tree, std::uint32_t level, std::uint32_t index) {
  return tree.level_begin[level - 1] + index;
}

double gap(const BoxOf& a, const BoxOf& b) {
  double sum = 0;
  for (std::size_t k = 0; k < 3; ++k) {
    const double g = std::max({b.low[k] - a.high[k], a.low[k] - b.high[k], 0.0});
    sum += g * g;
  }
  return sum;
}

/// How deep two boxes that meet are in each other, along the axis where it is least.
template <class Boxes>
double overlap(const BoxOf& box, const Boxes& boxes, std::size_t i) {
  double least = std::numeric_limits<double>::infinity();
  for (std::size_t k = 0; k < 3; ++k)
    least = std::min({least, box.high[k] - static_cast<double>(boxes.low[k][i]),
                      static_cast<double>(boxes.high[k][i]) - box.low[k]});
  return least;
}

BoxOf box_of(const exact::Corners& t) {
  const exact::Box box = exact::box_of(t);
  return {vec(box.low), vec(box.high)};
}

/// The lowest place of a box along a direction.
double lowest(const Vec& way, const BoxOf& box) {
  double out = 0;
  for (std::size_t k = 0; k < 3; ++k) out += way[k] * (way[k] > 0 ? box.low[k] : box.high[k]);
  return out;
}

/// The highest of a triangle's corners along it.
double highest(const Vec& way, const std::array<double, 9>& corners) {
  double out = -std::numeric_limits<double>::infinity();
  for (std::size_t c = 0; c < 9; c += 3)
    out = std::max(out, way[0] * corners[c] + way[1] * corners[c + 1] + way[2] * corners[c + 2]);
  return out;
}

/// A bit for each of eight triangles that does not lie wholly above a place along it.
unsigned up_to(const Vec& way, const std::array<std::array<std::int32_t, kLanes>, 9>& corners, double place) {
  std::array<double, kLanes> low;
  for (std::size_t c = 0; c < 9; c += 3)
    for (std::size_t i = 0; i < kLanes; ++i) {
      const double at = way[0] * corners[c][i] + way[1] * corners[c + 1][i] + way[2] * corners[c + 2][i];
      low[i] = c == 0 ? at : std::min(low[i], at);
    }
  unsigned out = 0;
  for (std::size_t i = 0; i < kLanes; ++i) out |= low[i] <= place ? 1u << i : 0u;
  return out;
}

constexpr double kAlongSlack = 0x1p-8;  // more than places along a way are off by, steps

}  // namespace

PairTrees::PairTrees(const SceneGeometry& of)
    : geometry(&of),
      mockup(TriangleTree::make(
          of.mockup, [] { return true; }, kTriangleCollapsed)),
      tool(TriangleTree::make(
          of.tool, [] { return true; }, kTriangleCollapsed)),
      spheres(of.tool, tool),
      field(RoomField::of(of, mockup)),
      corners((mockup.order.size() + kLanes - 1) / kLanes),
      boxes(corners.size()) {
  for (std::size_t place = 0; place < mockup.order.size(); ++place)
    for (std::size_t c = 0; c < 3; ++c) {
      const Int3 p = of.mockup.corner(mockup.order[place], static_cast<int>(c));
      for (std::size_t k = 0; k < 3; ++k) {
        const std::int32_t v = p[static_cast<int>(k)];
        TriangleTree::Boxes& box = boxes[place / kLanes];
        corners[place / kLanes][3 * c + k][place % kLanes] = v;
        box.low[k][place % kLanes] = c == 0 ? v : std::min(box.low[k][place % kLanes], v);
        box.high[k][place % kLanes] = c == 0 ? v : std::max(box.high[k][place % kLanes], v);
      }
    }
}

std::uint64_t PairTrees::most_bytes(const SceneGeometry& geometry) {
  constexpr std::uint64_t kATriangle = 160, kBesides = 1 << 16;  // what is kept, twice while trees are made
  return RoomField::most_bytes_made(geometry) + kBesides +
         kATriangle * (geometry.mockup.triangles.size() + geometry.tool.triangles.size());
}

PairSearch::PairSearch(const PairTrees& trees) : trees_(&trees) {}

void PairSearch::begin(const LatticePose& pose) {
  pose_ = pose;
  turn_ = trees_->field.turn(pose, trees_->geometry->tool_radius);
}

exact::Corners PairSearch::mobile(std::uint32_t id) const {
  const LatticeMesh& mesh = trees_->geometry->tool;
  return {transform(pose_, mesh.corner(id, 0)), transform(pose_, mesh.corner(id, 1)),
          transform(pose_, mesh.corner(id, 2))};
}
exact::Corners PairSearch::fixed(std::uint32_t id) const {
  const LatticeMesh& mesh = trees_->geometry->mockup;
  return {mesh.corner(id, 0), mesh.corner(id, 1), mesh.corner(id, 2)};
}
/// The lowest place of the mock-up's runs' boxes along a direction.
double PairSearch::floor_along(const std::array<double, 3>& way) const {
  const TriangleTree& mockup = trees_->mockup;
  double out = std::numeric_limits<double>::infinity();
  constexpr std::size_t kMostOpen = 8 * 32;  // eight a level
  std::array<Node, kMostOpen> open;
  std::size_t count = 0;
  open[count++] = {static_cast<std::uint32_t>(mockup.level_begin.size()), 0, -out};
  while (count != 0) {
    const Node node = open[--count];
    if (node.squared >= out) continue;
    const TriangleTree::Boxes& boxes = mockup.boxes[group_of(mockup, node.level, node.index)];
    const std::uint32_t all = children(mockup, node.level, node.index);
    const std::size_t first = count;
    for (std::uint32_t i = 0; i < all; ++i) {
      const double low = lowest(way, box_at(boxes, i));
      if (node.level == 1)
        out = std::min(out, low);
      else if (low < out)
        open[count++] = {node.level - 1, kWide * node.index + i, low};
    }
    // The lowest last, which is looked into first.
    for (std::size_t i = first; i + 1 < count; ++i)
      if (open[i].squared < open[count - 1].squared) std::swap(open[i], open[count - 1]);
  }
  return out;
}

bool PairSearch::meet(std::uint32_t static_id, std::uint32_t mobile_id) const {
  const exact::Corners t = mobile(mobile_id);
  const exact::Normal n = exact::raw_normal(t);
  return !(n == exact::Normal{}) && exact::triangles_meet(fixed(static_id), t, n);
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
    if (group.level != 0)
      for (std::uint32_t n = 0; n < count; ++n)
        groups_.push_back({group.level - 1, kWide * group.number + order[n]});
    else if (Policy::kNearestFirst)
      leads_.push_back(lead);
    else if (!descend(policy, lead))
      return false;
  }
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
    if (exact::raw_normal(m.at) == exact::Normal{}) continue;  // collinear at this pose: in no pair
    if (lead.rooms[i] < trees_->field.detail_steps() && trees_->field.all_beyond(m.at, policy.within_steps()))
      continue;
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
        if (!group(policy, mobiles_[i], node.index)) return false;
      continue;
    }
    const TriangleTree::Boxes& boxes = mockup.boxes[group_of(mockup, node.level, node.index)];
    box_gaps(run_box_, boxes, gaps);
    policy.aim({mobiles_.data(), count_});
    const std::uint32_t count =
        sorted(policy, run_box_, boxes, gaps, children(mockup, node.level, node.index), order);
    for (std::uint32_t n = 0; n < count; ++n)
      open_.push_back({node.level - 1, kWide * node.index + order[n], gaps[order[n]]});
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

/// A triangle and eight runs.
template <class Policy>
bool PairSearch::group(Policy& policy, const Mobile& m, std::uint32_t number) {
  const TriangleTree& mockup = trees_->mockup;
  const TriangleTree::Boxes& boxes = mockup.boxes[group_of(mockup, 1, number)];
  const std::uint32_t all = children(mockup, 1, number);
  std::array<double, kLanes> gaps, turned;
  std::array<std::uint32_t, kLanes> order;
  box_gaps(m.box, boxes, gaps);
  bool any = false;
  for (std::uint32_t i = 0; i < all; ++i) any = any || policy.near(gaps[i]);
  if (!any) return true;
  turned_gaps(m.corners, mockup.turned[number], turned);
  policy.aim({&m, 1});
  for (std::uint32_t n = sorted(policy, m.box, boxes, gaps, all, order); n-- > 0;)
    if (policy.near(std::max(gaps[order[n]], turned[order[n]])) &&
        !leaf(policy, m, kWide * number + order[n], box_at(boxes, order[n])))
      return false;
  return true;
}

template <class Policy>
bool PairSearch::leaf(Policy& policy, const Mobile& m, std::uint32_t run, const BoxOf& run_box) {
  const std::uint32_t count =
      std::min(kWide, static_cast<std::uint32_t>(trees_->mockup.order.size()) - kWide * run);
  std::array<double, kLanes> gaps;
  box_gaps(m.box, trees_->boxes[run], gaps);
  // Pairs that meet first: their corners and edges may be far from each other.
  unsigned mask = 0, crossing = 0;
  for (std::uint32_t lane = 0; lane < count; ++lane) {
    if (policy.near(gaps[lane])) mask |= 1u << lane;
    if (gaps[lane] == 0) crossing |= 1u << lane;
  }
  if (mask == 0) return true;
  const auto& corners = trees_->corners[run];
  const std::uint32_t* const ids = &trees_->mockup.order[kWide * run];
  if (crossing != 0) {
    std::array<PairFilter::Verdict, PairFilter::kLanes> verdicts{};
    filter_.put(corners, m.at);
    filter_.judge(verdicts);
    for (std::uint32_t lane = 0; lane < count; ++lane) {
      if ((crossing >> lane & 1) == 0 || verdicts[lane] == PairFilter::kApart) continue;
      if (verdicts[lane] == PairFilter::kUnknown &&
          !exact::triangles_meet(fixed(ids[lane]), m.at, exact::raw_normal(m.at)))
        continue;
      policy.met(ids[lane], m.id);
      return false;
    }
  }
  if (!policy.wants_distances()) return true;
  mask &= policy.near_along(corners);
  if (mask == 0) return true;
  PairLanes lanes{.s = &corners};
  lanes.take(m.at);
  std::array<double, kLanes> squared;
  rooms(lanes, squared);
  for (std::uint32_t lane = 0; lane < count; ++lane) {
    const double room = std::max(std::sqrt(squared[lane]) - kRoomError, 0.0);
    if (!policy.near(room * room)) mask &= ~(1u << lane);
  }
  if (mask == 0) return true;
  distances(lanes, squared);
  // No edge is longer than twice its box's longest side.
  const double edge = 2 * largest(m.box), reach = edge + 2 * largest(run_box);
  for (; mask != 0; mask &= mask - 1) {
    const auto lane = static_cast<std::size_t>(std::countr_zero(mask));
    const double distance = std::sqrt(squared[lane]);
    policy.pair(ids[lane], m.id, m.at, distance,
                distance_error(std::min(edge, 2 * largest(run_box)), reach + distance));
  }
  return true;
}

struct PairSearch::Any {
  static constexpr bool kNearestFirst = false;  ///< one that meets is as good as another
  bool found = false, close = false;
  std::array<std::uint32_t, 2> who{};
  double within_steps() const { return kCloseSteps; }
  bool within(double room) const { return room <= kCloseSteps; }
  bool near(double squared) const { return squared <= kCloseSteps * kCloseSteps; }
  bool keep(double squared, const BoxOf&, const BoxOf&) const { return near(squared); }
  static bool known() { return false; }
  static double room_along(const Vec&) { return 0; }
  void aim(std::span<const Mobile>) {}
  static unsigned near_along(const Lanes&) { return ~0u; }
  void met(std::uint32_t s, std::uint32_t m) {
    found = true;
    who = {s, m};
  }
  bool wants_distances() const { return !close; }
  void pair(std::uint32_t, std::uint32_t, const exact::Corners&, double distance, double error) {
    close = close || distance - error <= kCloseSteps;
  }
};

PairSearch::Found PairSearch::any(const LatticePose& pose) {
  begin(pose);
  for (std::size_t i = 0; i < met_count_; ++i)
    if (meet(met_[i][0], met_[i][1])) {
      std::swap(met_[0], met_[i]);
      return Found::kMeet;
    }
  Any policy;
  search(policy);
  if (!policy.found) return policy.close ? Found::kClose : Found::kNothing;
  met_[1] = met_[0];
  met_[0] = policy.who;
  met_count_ = std::min<std::size_t>(met_count_ + 1, met_.size());
  return Found::kMeet;
}

/// What is nearest. What is far from each other is told apart best along the way between the two that are
/// nearest so far: no box and no normal knows it.
struct PairSearch::Nearest {
  static constexpr bool kNearestFirst = true;
  const PairSearch& search;
  std::vector<Candidate>& candidates;
  double most;              ///< no pair is wanted that is a step further than this
  double most_squared = 0;  ///< (most + 1)², and a little
  bool found = false;
  Vec way{};                           ///< from the tool to the mock-up, of length 1
  double top = 0;                      ///< of what is looked at, along it
  double floor = 0;                    ///< of all of the mock-up, along it
  bool aimed = false, turned = false;  ///< whether there are a top and a way
  void set(double distance) {
    most = distance;
    most_squared = (most + 1) * (most + 1) * (1 + 0x1p-40) + 0x1p-20;
  }
  void turn_to(const NearestPoints& points) {
    aimed = turned = false;
    if (!(points.squared > 1)) return;
    way = (points.on_s - points.on_m) * (1 / std::sqrt(points.squared));
    floor = search.floor_along(way);
    turned = true;
  }
  bool known() const { return turned; }
  /// Of a place, to all of the mock-up.
  double room_along(const Vec& at) const { return floor - dot(way, at) - kAlongSlack; }
  double within_steps() const { return most + 1; }
  bool within(double room) const { return room <= most + 1; }
  bool near(double squared) const { return squared <= most_squared; }
  bool keep(double squared, const BoxOf&, const BoxOf& mockup) const {
    return near(squared) && (!aimed || lowest(way, mockup) - top <= most + 1 + kAlongSlack);
  }
  void aim(std::span<const Mobile> tool) {
    aimed = turned;
    if (!turned) return;
    top = -std::numeric_limits<double>::infinity();
    for (const Mobile& m : tool) top = std::max(top, highest(way, m.corners));
  }
  /// A bit for each of eight triangles that may be near, as far as the way tells.
  unsigned near_along(const Lanes& corners) const {
    if (!aimed) return ~0u;
    return up_to(way, corners, top + most + 1 + kAlongSlack);
  }
  void met(std::uint32_t, std::uint32_t) { found = true; }
  bool wants_distances() const { return true; }
  void pair(std::uint32_t s, std::uint32_t m, const exact::Corners& tool, double distance, double error) {
    if (distance - error >= most + 1) return;
    candidates.push_back({s, m, distance - error});
    if (distance + error >= most) return;
    set(distance + error);
    const exact::Corners at = search.fixed(s);
    turn_to(nearest_points({vec(at[0]), vec(at[1]), vec(at[2])}, {vec(tool[0]), vec(tool[1]), vec(tool[2])}));
  }
};

Clearance PairSearch::nearest(const LatticePose& pose, std::int32_t within) {
  begin(pose);
  candidates_.clear();
  Nearest policy{*this, candidates_, 0};
  policy.set(static_cast<double>(within) + 1);
  // The pair that was nearest last is about as near now: further ones need not be looked at.
  if (near_[0] != kNoTriangle) {
    const exact::Corners m = mobile(near_[1]);
    if (!(exact::raw_normal(m) == exact::Normal{})) {
      const exact::Corners s = fixed(near_[0]);
      const auto d =
          nearest_points({vec(s[0]), vec(s[1]), vec(s[2])},
                         {vec(m[0]), vec(m[1]), vec(m[2])});  // true points: no pair is nearer than it is
      policy.set(std::min(policy.most, std::sqrt(d.squared) + 1));
      policy.turn_to(d);
    }
  }
  search(policy);
  if (policy.found) return {.kind = Clearance::Kind::kTouching};
  // Which of those within a step of each other are nearest, and of these the pair with the smallest ids:
  // integers decide.
  std::erase_if(candidates_, [&](const Candidate& c) { return c.least >= policy.most + 1; });
  std::sort(candidates_.begin(), candidates_.end(), [](const Candidate& a, const Candidate& b) {
    return a.static_id != b.static_id ? a.static_id < b.static_id : a.mobile_id < b.mobile_id;
  });
  Clearance out;
  int feature = -1;
  for (const Candidate& c : candidates_) {
    const std::int32_t most = out.kind == Clearance::Kind::kApart ? out.steps - 1 : within;
    if (c.least >= static_cast<double>(most) + 1) continue;
    const exact::Gap gap = exact::gap(fixed(c.static_id), mobile(c.mobile_id), most);
    if (gap.steps > most) continue;
    out = {.kind = Clearance::Kind::kApart,
           .steps = gap.steps,
           .static_id = c.static_id,
           .mobile_id = c.mobile_id};
    feature = gap.feature;
  }
  if (out.kind != Clearance::Kind::kApart) return out;
  exact::witnesses(fixed(out.static_id), mobile(out.mobile_id), feature, out.on_static, out.on_mobile);
  near_ = {out.static_id, out.mobile_id};
  return out;
}

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
  unsigned near_along(const Lanes& corners) const {
    if (!aimed) return ~0u;
    return up_to(way, corners, top + closed);
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
           .steps = static_cast<std::int32_t>(std::max(distance, 0.0)),
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

#include "compute/native/queries/pair_search.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "compute/native/queries/pair_gap.h"

namespace palpate::native {
namespace {

constexpr std::uint32_t kWide = kLanes;
constexpr double kNowhereSteps = 0x1p40;  // where no triangle is
using Vec = std::array<double, 3>;

Vec operator-(const Vec& a, const Vec& b) { return {a[0] - b[0], a[1] - b[1], a[2] - b[2]}; }
Vec operator+(const Vec& a, const Vec& b) { return {a[0] + b[0], a[1] + b[1], a[2] + b[2]}; }
Vec operator*(const Vec& a, double f) { return {a[0] * f, a[1] * f, a[2] * f}; }
double dot(const Vec& a, const Vec& b) { return a[0] * b[0] + a[1] * b[1] + a[2] * b[2]; }
Vec cross(const Vec& a, const Vec& b) {
  return {a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]};
}
double length(const Vec& a) { return std::sqrt(dot(a, a)); }
Vec vec(const Int3& p) {
  return {static_cast<double>(p.x), static_cast<double>(p.y), static_cast<double>(p.z)};
}
Vec vec(const Vec3& p) { return {p.x, p.y, p.z}; }

double largest(const BoxOf& box) {
  return std::max({box.high[0] - box.low[0], box.high[1] - box.low[1], box.high[2] - box.low[2]});
}
BoxOf union_of(const TriangleTree::Boxes& boxes, std::uint32_t count) {
  BoxOf out;
  for (std::size_t k = 0; k < 3; ++k) {
    out.low[k] = *std::min_element(boxes.low[k].begin(), boxes.low[k].begin() + count);
    out.high[k] = *std::max_element(boxes.high[k].begin(), boxes.high[k].begin() + count);
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

struct NearestPoints {
  double squared = std::numeric_limits<double>::infinity();
  Vec on_s{}, on_m{};
  void take(const Vec& s, const Vec& m) {
    const Vec way = m - s;
    const double d = dot(way, way);
    if (d < squared) *this = {d, s, m};
  }
};

/// A direction across which two triangles are apart is all that is wanted: whatever it is worth is measured
/// along it.
NearestPoints nearest_points(const std::array<Vec, 3>& s, const std::array<Vec, 3>& m) {
  NearestPoints out;
  const auto above = [&](const Vec& p, const std::array<Vec, 3>& t, bool of_m) {
    const Vec n = cross(t[1] - t[0], t[2] - t[0]);
    const double size = dot(n, n);
    if (!(size > 0)) return;
    for (std::size_t e = 0; e < 3; ++e)
      if (dot(cross(n, t[(e + 1) % 3] - t[e]), p - t[e]) < 0) return;
    const Vec foot = p - n * (dot(n, p - t[0]) / size);
    if (of_m)
      out.take(foot, p);
    else
      out.take(p, foot);
  };
  for (std::size_t c = 0; c < 3; ++c) {
    above(m[c], s, true);
    above(s[c], m, false);
  }
  for (std::size_t i = 0; i < 3; ++i)
    for (std::size_t j = 0; j < 3; ++j) {
      const Vec e = s[(i + 1) % 3] - s[i], f = m[(j + 1) % 3] - m[j], r = s[i] - m[j];
      const double ee = dot(e, e), ff = dot(f, f), ef = dot(e, f), er = dot(e, r), fr = dot(f, r),
                   under = ee * ff - ef * ef;
      double a = under > 0 ? std::clamp((ef * fr - er * ff) / under, 0.0, 1.0) : 0.0;
      const double b = std::clamp((ef * a + fr) / ff, 0.0, 1.0);
      a = std::clamp((ef * b - er) / ee, 0.0, 1.0);
      out.take(s[i] + e * a, m[j] + f * b);
    }
  return out;
}

}  // namespace

PairTrees::PairTrees(const SceneGeometry& of)
    : geometry(&of),
      mockup(TriangleTree::make(
          of.mockup, [] { return true; }, kTriangleCollapsed)),
      tool(TriangleTree::make(
          of.tool, [] { return true; }, kTriangleCollapsed)),
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

PairSearch::PairSearch(const PairTrees& trees)
    : trees_(&trees), runs_(trees.tool.nodes(0)), groups_(trees.tool.boxes.size()) {
  const auto root = [](const TriangleTree& tree) {
    return tree.boxes.empty()
               ? BoxOf{}
               : union_of(tree.boxes.back(),
                          children(tree, static_cast<std::uint32_t>(tree.level_begin.size()), 0));
  };
  mockup_root_ = root(trees.mockup);
  tool_root_ = root(trees.tool);
}

void PairSearch::begin(const LatticePose& pose) {
  pose_ = pose;
  for (std::size_t r = 0; r < 3; ++r)
    for (std::size_t c = 0; c < 3; ++c) {
      rotation_[r][c] = pose.rotation_q30[r][c] * 0x1p-30;
      size_[r][c] = std::abs(rotation_[r][c]);
    }
  if (++now_ != 0) return;
  for (Run& run : runs_) run.pose = run.placed = 0;  // once in 2^32 poses
  for (Group& group : groups_) group.pose = 0;
  now_ = 1;
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
bool PairSearch::meet(std::uint32_t static_id, std::uint32_t mobile_id) const {
  const exact::Corners t = mobile(mobile_id);
  const exact::Normal n = exact::raw_normal(t);
  return !(n == exact::Normal{}) && exact::triangles_meet(fixed(static_id), t, n);
}

// Turned vertices are rounded by half a step an axis, doubles are off by far less than the other half.
const EightDoubles& PairSearch::posed_boxes(std::uint32_t number) {
  Group& group = groups_[number];
  if (group.pose == now_) return group.boxes;
  group.pose = now_;
  const TriangleTree::Boxes& own = trees_->tool.boxes[number];
  for (std::size_t r = 0; r < 3; ++r)
    for (std::size_t i = 0; i < kLanes; ++i) {
      double centre = pose_.translation[static_cast<int>(r)], half = 1;
      for (std::size_t c = 0; c < 3; ++c) {
        const double low = own.low[c][i], high = own.high[c][i];
        centre += rotation_[r][c] * (0.5 * (low + high));
        half += size_[r][c] * (0.5 * (high - low));
      }
      group.boxes.low[r][i] = centre - half;
      group.boxes.high[r][i] = centre + half;
    }
  return group.boxes;
}

const PairSearch::Run& PairSearch::posed_run(std::uint32_t number) {
  Run& run = runs_[number];
  if (run.pose == now_) return run;
  run.pose = now_;
  for (std::size_t i = 0; i < kLanes; ++i) {
    const std::size_t place = kWide * number + i;
    for (std::size_t k = 0; k < 3; ++k) run.boxes.low[k][i] = run.boxes.high[k][i] = kNowhereSteps;
    if (place >= trees_->tool.order.size()) continue;
    const exact::Corners& t = run.corners[i] = mobile(trees_->tool.order[place]);
    if (exact::raw_normal(t) == exact::Normal{}) continue;  // collinear at this pose: in no pair
    const BoxOf box = box_of(t);
    for (std::size_t k = 0; k < 3; ++k) {
      run.boxes.low[k][i] = box.low[k];
      run.boxes.high[k][i] = box.high[k];
    }
  }
  return run;
}

const PairSearch::Places& PairSearch::posed_places(std::uint32_t number) {
  Run& run = runs_[number];
  if (run.placed == now_) return run.places;
  run.placed = now_;
  bool first = true;
  for (std::size_t i = 0; i < kLanes; ++i) {
    if (run.boxes.low[0][i] == kNowhereSteps) continue;  // no triangle
    for (std::size_t c = 0; c < 3; ++c)
      for (std::size_t k = 0; k < 3; ++k) {
        const double at = run.corners[i][c][static_cast<int>(k)];
        auto& lanes = run.places[3 * c + k];
        if (first)
          lanes.fill(at);
        else
          lanes[i] = at;
      }
    first = false;
  }
  return run.places;
}

/// Calls policy.lanes() for every tool triangle and run of the mock-up between which boxes leave room for
/// what the policy wants. A policy has
///   bool keep(squared, tool box, mock-up box): whether what is in them may matter;
///   bool lanes(number of tool triangle, its id, run, mock-up run, mask): of eight pairs those in the mask
///     may matter; false: it knows enough.
template <class Policy>
void PairSearch::descend(Policy& policy) {
  const TriangleTree &tool = trees_->tool, &mockup = trees_->mockup;
  if (tool.boxes.empty() || mockup.boxes.empty()) return;
  open_.clear();
  BoxOf tool_box;
  for (std::size_t r = 0; r < 3; ++r) {
    double centre = pose_.translation[static_cast<int>(r)], half = 1;
    for (std::size_t c = 0; c < 3; ++c) {
      centre += rotation_[r][c] * (0.5 * (tool_root_.low[c] + tool_root_.high[c]));
      half += size_[r][c] * (0.5 * (tool_root_.high[c] - tool_root_.low[c]));
    }
    tool_box.low[r] = centre - half;
    tool_box.high[r] = centre + half;
  }
  open_.push_back({{static_cast<std::uint32_t>(tool.level_begin.size()), 0},
                   {static_cast<std::uint32_t>(mockup.level_begin.size()), 0},
                   tool_box,
                   mockup_root_,
                   gap(tool_box, mockup_root_)});
  std::array<double, kLanes> gaps;
  while (!open_.empty()) {
    const Item item = open_.back();
    open_.pop_back();
    if (!policy.keep(item.squared, item.tool_box, item.mockup_box)) continue;
    ++looks_;
    if (item.tool.level == 0 && item.mockup.level == 0) {
      if (!leaf(policy, item)) return;
      continue;
    }
    const bool turn_tool =
        item.mockup.level == 0 || (item.tool.level != 0 && largest(item.tool_box) > largest(item.mockup_box));
    std::array<std::uint32_t, kLanes> order;
    std::uint32_t count = 0, first = 0;
    // Of those that may matter the furthest first, so that the nearest, or the two that overlap most, are on
    // top then.
    const auto sort_in = [&](std::uint32_t all, const BoxOf& box, const auto& boxes) {
      std::array<double, kLanes> rank;
      for (std::uint32_t i = 0; i < all; ++i) {
        if (!policy.near(gaps[i])) continue;
        rank[i] = gaps[i] > 0 ? gaps[i] : -overlap(box, boxes, i);
        std::uint32_t at = count++;
        for (; at > 0 && rank[order[at - 1]] < rank[i]; --at) order[at] = order[at - 1];
        order[at] = i;
      }
    };
    if (turn_tool) {
      const EightDoubles& boxes = posed_boxes(group_of(tool, item.tool.level, item.tool.index));
      first = kWide * item.tool.index;
      box_gaps(item.mockup_box, boxes, gaps);
      sort_in(children(tool, item.tool.level, item.tool.index), item.mockup_box, boxes);
      for (std::uint32_t n = 0; n < count; ++n) {
        const BoxOf box = boxes.box(order[n]);
        if (policy.keep(gaps[order[n]], box, item.mockup_box))
          open_.push_back(
              {{item.tool.level - 1, first + order[n]}, item.mockup, box, item.mockup_box, gaps[order[n]]});
      }
    } else {
      const TriangleTree::Boxes& boxes = mockup.boxes[group_of(mockup, item.mockup.level, item.mockup.index)];
      first = kWide * item.mockup.index;
      box_gaps(item.tool_box, boxes, gaps);
      sort_in(children(mockup, item.mockup.level, item.mockup.index), item.tool_box, boxes);
      for (std::uint32_t n = 0; n < count; ++n) {
        const std::size_t i = order[n];
        const BoxOf box{{static_cast<double>(boxes.low[0][i]), static_cast<double>(boxes.low[1][i]),
                         static_cast<double>(boxes.low[2][i])},
                        {static_cast<double>(boxes.high[0][i]), static_cast<double>(boxes.high[1][i]),
                         static_cast<double>(boxes.high[2][i])}};
        if (policy.keep(gaps[i], item.tool_box, box))
          open_.push_back(
              {item.tool, {item.mockup.level - 1, first + order[n]}, item.tool_box, box, gaps[i]});
      }
    }
  }
}

/// Square of what a run of the tool is apart from the box of one of the mock-up's runs that lies along its
/// triangles; no more than that. Axes are floats, so each gap is taken shorter by 2^-20 of itself and a step,
/// and the sum by 2^-20, which is more than they are off (docs/EXACTNESS.md, section 9).
double PairSearch::turned_gap(std::uint32_t fixed_run, const Places& places) const {
  const TriangleTree::TurnedBoxes& turned = trees_->mockup.turned[fixed_run / kWide];
  const std::size_t i = fixed_run % kWide;
  double ways[3][3], low[3], high[3], sum = 0;
  for (std::size_t a = 0; a < 3; ++a)
    for (std::size_t k = 0; k < 3; ++k) ways[a][k] = turned.axis[a][k][i];
  places_along(places, ways, low, high);
  for (std::size_t a = 0; a < 3; ++a) {
    double origin = 0;
    for (std::size_t k = 0; k < 3; ++k) origin += ways[a][k] * turned.corner[k][i];
    const double gap = std::max(low[a] - origin - turned.high[a][i], turned.low[a][i] - (high[a] - origin)),
                 sure = gap * (1 - 0x1p-20) - 1;
    if (sure > 0) sum += sure * sure;
  }
  return sum * (1 - 0x1p-20);
}

template <class Policy>
bool PairSearch::leaf(Policy& policy, const Item& item) {
  const Run& run = posed_run(item.tool.index);
  if constexpr (Policy::kTurned)
    if (!policy.near(turned_gap(item.mockup.index, posed_places(item.tool.index)))) return true;
  const std::uint32_t statics = item.mockup.index,
                      count = std::min(
                          kWide, static_cast<std::uint32_t>(trees_->mockup.order.size()) - kWide * statics);
  const TriangleTree::Boxes& boxes = trees_->boxes[statics];
  std::array<double, kLanes> gaps, of_triangles;
  box_gaps(item.mockup_box, run.boxes, of_triangles);
  for (std::size_t i = 0; i < kLanes; ++i) {
    if (!policy.near(of_triangles[i])) continue;
    const BoxOf box = run.boxes.box(i);
    if (run.boxes.low[0][i] == kNowhereSteps || !policy.keep(of_triangles[i], box, item.mockup_box)) continue;
    box_gaps(box, boxes, gaps);
    unsigned mask = 0;
    for (std::uint32_t lane = 0; lane < count; ++lane)
      if (policy.near(gaps[lane])) mask |= 1u << lane;
    ++looks_;
    if (mask == 0) continue;
    // Pairs that meet first: their corners and edges may be far from each other.
    unsigned crossing = 0;
    for (std::uint32_t lane = 0; lane < count; ++lane)
      if ((mask >> lane & 1) != 0 && gaps[lane] == 0) crossing |= 1u << lane;
    const auto& corners = trees_->corners[statics];
    const std::uint32_t mobile_id = trees_->tool.order[kWide * item.tool.index + i];
    if (crossing != 0) {
      std::array<PairFilter::Verdict, PairFilter::kLanes> verdicts{};
      const auto fixed_corners = [&](std::size_t lane) {
        return exact::Corners{Int3(corners[0][lane], corners[1][lane], corners[2][lane]),
                              Int3(corners[3][lane], corners[4][lane], corners[5][lane]),
                              Int3(corners[6][lane], corners[7][lane], corners[8][lane])};
      };
      filter_.put(corners, run.corners[i]);
      filter_.judge(verdicts);
      for (std::uint32_t lane = 0; lane < count; ++lane) {
        if ((crossing >> lane & 1) == 0 || verdicts[lane] == PairFilter::kApart) continue;
        if (verdicts[lane] == PairFilter::kUnknown &&
            !exact::triangles_meet(fixed_corners(lane), run.corners[i], exact::raw_normal(run.corners[i])))
          continue;
        policy.met(trees_->mockup.order[kWide * statics + lane], mobile_id);
        return false;
      }
    }
    if (!policy.wants_distances()) continue;
    PairLanes lanes{.s = &corners};
    lanes.take(run.corners[i]);
    std::array<double, kLanes> squared;
    rooms(lanes, squared);
    for (std::uint32_t lane = 0; lane < count; ++lane) {
      const double room = std::max(std::sqrt(squared[lane]) - kRoomError, 0.0);
      if (!policy.near(room * room)) mask &= ~(1u << lane);
    }
    if (mask == 0) continue;
    distances(lanes, squared);
    // No edge is longer than twice its box's longest side.
    const double edge = 2 * largest(box), reach = edge + 2 * largest(item.mockup_box);
    for (std::uint32_t lane = 0; lane < count; ++lane) {
      if ((mask >> lane & 1) == 0) continue;
      const double distance = std::sqrt(squared[lane]);
      policy.pair(trees_->mockup.order[kWide * statics + lane], mobile_id, run.corners[i], distance,
                  distance_error(std::min(edge, 2 * largest(item.mockup_box)), reach + distance));
    }
  }
  return true;
}

struct PairSearch::Any {
  static constexpr bool kTurned =
      false;  ///< whether boxes along the triangles are worth a look: nearer, few are left out
  bool found = false, close = false;
  std::array<std::uint32_t, 2> who{};
  bool near(double squared) const { return squared <= kCloseSteps * kCloseSteps; }
  bool keep(double squared, const BoxOf&, const BoxOf&) const { return near(squared); }
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
  descend(policy);
  if (!policy.found) return policy.close ? Found::kClose : Found::kNothing;
  met_[1] = met_[0];
  met_[0] = policy.who;
  met_count_ = std::min<std::size_t>(met_count_ + 1, met_.size());
  return Found::kMeet;
}

struct PairSearch::Nearest {
  static constexpr bool kTurned = true;
  std::vector<Candidate>& candidates;
  double most;              ///< no pair is wanted that is a step further than this
  double most_squared = 0;  ///< (most + 1)², and a little
  bool found = false;
  void set(double distance) {
    most = distance;
    most_squared = (most + 1) * (most + 1) * (1 + 0x1p-40) + 0x1p-20;
  }
  bool near(double squared) const { return squared <= most_squared; }
  bool keep(double squared, const BoxOf&, const BoxOf&) const { return near(squared); }
  void met(std::uint32_t, std::uint32_t) { found = true; }
  bool wants_distances() const { return true; }
  void pair(std::uint32_t s, std::uint32_t m, const exact::Corners&, double distance, double error) {
    if (distance - error >= most + 1) return;
    candidates.push_back({s, m, distance - error});
    if (distance + error < most) set(distance + error);
  }
};

Clearance PairSearch::nearest(const LatticePose& pose, std::int32_t within) {
  begin(pose);
  candidates_.clear();
  Nearest policy{candidates_, 0};
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
    }
  }
  descend(policy);
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
  static constexpr bool kTurned = true;
  const PairSearch& search;
  Vec axis, velocity, origin;
  double angle, time;        ///< the soonest so far
  double fastest;            ///< speed of the tool's fastest point, at most
  double reach_squared = 0;  ///< how far that one gets in `time`
  FreeTime out{};
  bool stop = false;

  void set(double sooner) {
    time = sooner;
    const double reach = fastest * time + kMotionSlack;
    reach_squared = reach * reach * (1 + 0x1p-40) + 1;
  }
  Vec speed_at(const Vec& p) const { return velocity + cross(axis, p - origin) * angle; }
  double across(const Vec& v) const { return length(v - axis * dot(axis, v)); }

  bool near(double squared) const { return squared <= reach_squared; }
  bool keep(double squared, const BoxOf& tool, const BoxOf& mockup) const {
    if (!near(squared)) return false;
    const double distance = std::sqrt(squared), need = distance - kMotionSlack - 1;
    if (need <= 0) return true;
    Vec way, centre, half;
    for (std::size_t k = 0; k < 3; ++k) {
      way[k] = (std::max(mockup.low[k] - tool.high[k], 0.0) - std::max(tool.low[k] - mockup.high[k], 0.0)) /
               distance;
      centre[k] = 0.5 * (tool.low[k] + tool.high[k]);
      half[k] = 0.5 * (tool.high[k] - tool.low[k]);
    }
    const Vec v = speed_at(centre), across_axis = cross(way, axis);
    const double turned = angle * length(half);
    if (time * (length(v) + turned) < need) return false;
    const double along =
        dot(v, way) + angle * (std::abs(across_axis[0]) * half[0] + std::abs(across_axis[1]) * half[1] +
                               std::abs(across_axis[2]) * half[2]);
    return time * along + 0.5 * time * time * angle * (across(v) + turned) >= need;
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
    if (sure > kMotionSlack) {
      const exact::Corners s_corners = search.fixed(s_id);
      const std::array<Vec, 3> s{vec(s_corners[0]), vec(s_corners[1]), vec(s_corners[2])},
          m{vec(m_corners[0]), vec(m_corners[1]), vec(m_corners[2])};
      const NearestPoints near = nearest_points(s, m);
      const Vec way = (near.on_s - near.on_m) * (1 / std::sqrt(near.squared));
      double room = std::numeric_limits<double>::infinity(), front = -room, along = -room, faster = 0,
             turning = 0;
      for (std::size_t c = 0; c < 3; ++c) {
        const Vec v = speed_at(m[c]);
        room = std::min(room, dot(way, s[c] - near.on_m));
        front = std::max(front, dot(way, m[c] - near.on_m));
        along = std::max(along, dot(way, v));
        faster = std::max(faster, length(v));
        turning = std::max(turning, across(v));
      }
      const double need =
          room - front - error -
          kMotionSlack;  // along `way` there is so much room between them, whatever `way` is worth
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
  descend(policy);
  if (policy.out.blocked) blocking_ = {policy.out.static_id, policy.out.mobile_id};
  return policy.out;
}

}  // namespace palpate::native

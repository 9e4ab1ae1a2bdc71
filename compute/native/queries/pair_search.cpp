#include "compute/native/queries/pair_search.h"

#include "compute/native/queries/pair_gap.h"
#include "compute/native/queries/pair_traversal.h"

namespace palpate::native {

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

struct PairSearch::Any {
  static constexpr bool kMoves = false, kNearestFirst = false;  ///< one that meets is as good as another
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
  void pair(std::uint32_t, std::uint32_t, const exact::Corners&, double distance, double error, std::size_t) {
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
  static constexpr bool kMoves = false, kNearestFirst = true;
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
  void pair(std::uint32_t s, std::uint32_t m, const exact::Corners& tool, double distance, double error,
            std::size_t feature) {
    if (distance - error >= most + 1) return;
    candidates.push_back({s, m, distance - error});
    if (distance + error >= most) return;
    set(distance + error);
    const exact::Corners at = search.fixed(s);
    turn_to(nearest_points({vec(at[0]), vec(at[1]), vec(at[2])}, {vec(tool[0]), vec(tool[1]), vec(tool[2])},
                           feature));
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

}  // namespace palpate::native

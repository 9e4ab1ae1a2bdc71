#include "compute/host_follow.h"

#include <algorithm>
#include <cmath>

namespace palpate {
namespace {

using namespace gpu;   // names of shaders/shared/frame.h

constexpr std::uint32_t kWhole = 1u << 30;   // weight of a needle's sample, Q30

/// A box that holds a ray up to its height: from p to p + d·(H + 1) / 2^30, and two steps for rounding.
struct Span {
  Int3 low, high;
};
Span span_of(const Int3& p, const Int3& d, std::uint32_t height) {
  Span out{p, p};
  for (int k = 0; k < 3; ++k) {
    const auto way = static_cast<std::int32_t>((std::int64_t{d[k]} * (std::int64_t{height} + 1)) >> 30);
    out.low[k] = std::min(p[k], p[k] + way) - 2;
    out.high[k] = std::max(p[k], p[k] + way) + 2;
  }
  return out;
}

bool meet(const Int3& low, const Int3& high, const Int3& other_low, const Int3& other_high) {
  return low.x <= other_high.x && low.y <= other_high.y && low.z <= other_high.z && other_low.x <= high.x && other_low.y <= high.y && other_low.z <= high.z;
}

/// Seen along the ray and dropped on each of the coordinate planes, the triangle's box must hold the ray. Products are within 2^59 and
/// doubles round them and their differences by less than 2^8.
bool may_cross(const Int3& p, const Int3& d, const exact::Corners& t) {
  constexpr double kMargin = 0x1p10;
  const double x = d.x, y = d.y, z = d.z;
  double low[3] = {INFINITY, INFINITY, INFINITY}, high[3] = {-INFINITY, -INFINITY, -INFINITY};
  for (const Int3& corner : t) {
    const double u = corner.x - p.x, v = corner.y - p.y, w = corner.z - p.z;
    const double beside[3] = {y * w - z * v, z * u - x * w, x * v - y * u};
    for (int k = 0; k < 3; ++k) {
      low[k] = std::min(low[k], beside[k]);
      high[k] = std::max(high[k], beside[k]);
    }
  }
  return low[0] <= kMargin && low[1] <= kMargin && low[2] <= kMargin && high[0] >= -kMargin && high[1] >= -kMargin && high[2] >= -kMargin;
}

}  // namespace

bool HostFollow::needles(PosedTool& tool, HostHeights& heights, const ContactLists& lists, const HostAreas& areas, std::span<const ContactPair> pairs,
                         std::uint32_t area_count, std::vector<RisenSample>& risen) {
  bool any = false;
  for (AreaWork& area : lists.areas.first(area_count)) {
    if (area.cst == 0 || area.direction == Int3(0) || area.rays != 0) continue;
    area.state |= kAreaNeedle;
    area.flags |= kAreaFlagNeedle;
    any = true;
  }
  if (!any) return true;

  const LatticeMesh &mockup = geometry_->mockup, &moved = geometry_->tool;
  const NearRays::Turn turn(tool.pose());
  vertices_.clear();
  std::uint32_t aimed = kNone;   // the area that heights are along
  for (const ContactPair& pair : pairs) {
    const std::uint32_t number = areas.area_of(pair.static_id, lists);
    AreaWork& area = lists.areas[number];
    if ((area.state & kAreaNeedle) == 0) continue;
    for (std::size_t k = 0; k < 3; ++k) vertices_.emplace_back(number, moved.triangles[pair.mobile][k]);

    // (a) The middle of where their edges cross each other.
    const exact::Corners s{mockup.corner(pair.static_id, 0), mockup.corner(pair.static_id, 1), mockup.corner(pair.static_id, 2)};
    const exact::Corners& m = tool.corners(pair.mobile);
    Int3 low(INT32_MAX), high(INT32_MIN), e;
    for (std::size_t k = 0; k < 3; ++k) {
      for (const bool of_static : {true, false}) {
        const exact::Corners &from = of_static ? s : m, &to = of_static ? m : s;
        if (!exact::edge_crossing(from[k], from[(k + 1) % 3], to, e)) continue;
        low = glm::min(low, e);
        high = glm::max(high, e);
      }
    }
    if (low.x > high.x) continue;
    const Int3 middle = (low + high) >> 1;
    std::uint32_t height = kNone;
    if (number != aimed) heights.aim(turn, -area.direction);
    aimed = number;
    if (!heights.height(tool, turn, middle, true, height)) return false;
    if (height == kNone) continue;
    HostHeights::add(area, middle, height, kWhole, 0);
    risen.push_back({number, middle, height});
  }
  take_vertices(tool, lists);
  return true;
}

/// (b) Tool vertices near needles: how far along n_c each leaves its area's surface.
void HostFollow::take_vertices(PosedTool& tool, const ContactLists& lists) {
  const LatticeMesh& mockup = geometry_->mockup;
  std::sort(vertices_.begin(), vertices_.end());
  vertices_.erase(std::unique(vertices_.begin(), vertices_.end()), vertices_.end());
  for (auto begin = vertices_.begin(); begin != vertices_.end();) {
    const std::uint32_t number = begin->first;
    AreaWork& area = lists.areas[number];
    const Int3 d = area.direction;
    slots_.clear();
    for (std::uint32_t slot = 0; slot < lists.statics.size(); ++slot)
      if (lists.statics[slot].area == number && (lists.statics[slot].state & kStaticHit) != 0) slots_.push_back(slot);
    for (; begin != vertices_.end() && begin->first == number; ++begin) {
      const Int3 p = transform(tool.pose(), geometry_->tool.vertices[begin->second]);
      std::uint32_t lowest = kNone;
      for (const std::uint32_t slot : slots_) {
        const std::uint32_t id = lists.statics[slot].id;
        const exact::Corners corners{mockup.corner(id, 0), mockup.corner(id, 1), mockup.corner(id, 2)};
        if (!may_cross(p, d, corners)) continue;
        const exact::Crossing crossing = exact::ray_crossing(p, d, corners);
        if (crossing.sign > 0 || (crossing.sign < 0 && (mockup.flags[id] & kTriangleSheet) != 0)) lowest = std::min(lowest, crossing.height);
      }
      if (lowest == kNone) continue;
      Int3 at;
      for (int k = 0; k < 3; ++k) at[k] = p[k] + static_cast<std::int32_t>((std::int64_t{d[k]} * lowest) >> 30);
      HostHeights::add(area, at, lowest, kWhole, 0);
    }
  }
}

/// Triangles of other areas that one area's rays may leave: all its rays have one direction, and go only as far as their heights.
void HostFollow::find_facing(const ContactLists& lists, std::uint32_t own, std::uint32_t area_count, std::span<const RisenSample> rays) {
  const LatticeMesh& mockup = geometry_->mockup;
  const Int3 d = -lists.areas[own].direction;
  Int3 low(INT32_MAX), high(INT32_MIN);
  for (const RisenSample& ray : rays) {
    const Span span = span_of(ray.point, d, ray.height);
    low = glm::min(low, span.low);
    high = glm::max(high, span.high);
  }
  facing_.clear();
  for (std::uint32_t other = 0; other < area_count; ++other) {
    const AreaWork& area = lists.areas[other];
    if (other == own || !meet(low, high, area.box_low, area.box_high)) continue;
    for (std::uint32_t i = first_slot_[other]; i < first_slot_[other + 1]; ++i) {
      const std::uint32_t id = lists.statics[slots_[i]].id;
      Facing f{other, {mockup.corner(id, 0), mockup.corner(id, 1), mockup.corner(id, 2)}, {}, {}};
      f.low = glm::min(glm::min(f.corners[0], f.corners[1]), f.corners[2]);
      f.high = glm::max(glm::max(f.corners[0], f.corners[1]), f.corners[2]);
      if (meet(low, high, f.low, f.high) && exact::dot(exact::raw_normal(f.corners), d) > 0) facing_.push_back(f);
    }
  }
}

void HostFollow::pierces(const ContactLists& lists, std::uint32_t area_count, std::vector<RisenSample>& risen, std::vector<AreaPierce>& out) {
  out.clear();
  if (area_count < 2 || risen.empty()) return;
  // C_s by area.
  first_slot_.assign(area_count + 1, 0);
  for (const StaticResult& s : lists.statics) first_slot_[s.area + 1] += 1;
  for (std::uint32_t area = 0; area < area_count; ++area) first_slot_[area + 1] += first_slot_[area];
  slots_.resize(lists.statics.size());
  for (std::uint32_t slot = 0; slot < lists.statics.size(); ++slot) slots_[first_slot_[lists.statics[slot].area]++] = slot;
  for (std::uint32_t area = area_count; area > 0; --area) first_slot_[area] = first_slot_[area - 1];
  first_slot_[0] = 0;

  const auto by_area = [](const RisenSample& a, const RisenSample& b) { return a.area < b.area; };
  if (!std::is_sorted(risen.begin(), risen.end(), by_area)) std::sort(risen.begin(), risen.end(), by_area);   // needles come last
  for (auto begin = risen.begin(); begin != risen.end();) {
    const std::uint32_t own = begin->area;
    const auto end = std::find_if(begin, risen.end(), [own](const RisenSample& ray) { return ray.area != own; });
    find_facing(lists, own, area_count, {begin, end});
    const Int3 d = -lists.areas[own].direction;
    std::array<bool, kMaxFrameAreas> pierced{};
    if (!facing_.empty())
      for (; begin != end; ++begin) {
        const Span span = span_of(begin->point, d, begin->height);
        std::uint32_t nearest = begin->height;   // crossings count below it
        std::array<std::uint32_t, kMaxFrameAreas> hit;   // the areas crossed at `nearest`
        std::size_t hits = 0;
        for (const Facing& f : facing_) {
          if (!meet(span.low, span.high, f.low, f.high) || !may_cross(begin->point, d, f.corners)) continue;
          const exact::Crossing crossing = exact::ray_crossing(begin->point, d, f.corners);
          if (crossing.sign <= 0 || crossing.height > nearest || (hits == 0 && crossing.height == nearest)) continue;
          if (crossing.height < nearest) hits = 0;
          nearest = crossing.height;
          if (std::find(hit.begin(), hit.begin() + static_cast<std::ptrdiff_t>(hits), f.area) == hit.begin() + static_cast<std::ptrdiff_t>(hits)) hit[hits++] = f.area;
        }
        for (std::size_t i = 0; i < hits; ++i) pierced[hit[i]] = true;
      }
    for (std::uint32_t other = 0; other < area_count; ++other)
      if (pierced[other]) out.push_back({own, other});
    begin = end;
  }
}

}  // namespace palpate

#include "compute/host_heights.h"

#include <algorithm>
#include <cstdlib>
#include <tuple>

namespace palpate {
namespace {

using namespace gpu;   // names of shaders/shared/frame.h

}  // namespace

/// Notes a crossing below `stop`.
void HostHeights::cross(PosedTool& tool, const Int3& p, std::uint32_t id, std::uint32_t stop) {
  const exact::Crossing crossing = exact::ray_crossing(p, along_, tool.corners(id));
  if (crossing.sign != 0 && crossing.height < stop) levels_.push_back({crossing.height, crossing.sign, id});
}

/// Notes what the ray from p crosses as far as height() looks. False: as sum().
bool HostHeights::walk(PosedTool& tool, const NearRays::Turn& turn, const Int3& p, bool through) {
  NearRays::Walk walk = rays_->begin(turn, p);
  HostList<std::uint32_t> places{places_};
  do {
    if (!rays_->go_on(walk, 0, places)) return false;
    const std::uint32_t stop = NearRays::stop_of(walk);
    levels_.clear();
    for (const std::uint32_t place : places.room.first(places.count)) cross(tool, p, order_[place], stop);
  } while (through && levels_.empty() && rays_->skip_external(walk));
  return true;
}

bool HostHeights::height(PosedTool& tool, const NearRays::Turn& turn, const Int3& p, bool through, std::uint32_t& out) {
  if (!walk(tool, turn, p, through)) return false;
  const std::uint32_t exit = lowest_exit();
  out = exit == kNone ? kNone : levels_[exit].height;
  return true;
}

/// Sorts the last ray's crossings by height; the last of those at the smallest height above which the signs add up to 0, or kNone.
std::uint32_t HostHeights::lowest_exit() {
  if (levels_.size() == 1) return 0;   // one crossing: nothing above it
  std::sort(levels_.begin(), levels_.end(), [](const Level& a, const Level& b) { return a.height < b.height; });
  std::int32_t above = 0;
  for (const Level& level : levels_) above += level.sign;
  for (std::uint32_t i = 0; i < levels_.size(); ++i) {
    above -= levels_[i].sign;
    if (above == 0 && (i + 1 == levels_.size() || levels_[i + 1].height != levels_[i].height)) return i;
  }
  return kNone;
}

/// Of the triangles crossed at the height of the last ray's exit, the smallest direction of a normal. Valid until the next call.
const Int3& HostHeights::exit_normal(PosedTool& tool, std::uint32_t exit) {
  const auto normal_of = [&](std::uint32_t id) -> const Int3& {
    if (id != left_) {
      left_ = id;
      left_normal_ = exact::normalise(exact::raw_normal(tool.corners(id)));
    }
    return left_normal_;
  };
  const auto less = [](const Int3& a, const Int3& b) { return std::tie(a.x, a.y, a.z) < std::tie(b.x, b.y, b.z); };
  const std::uint32_t height = levels_[exit].height;
  if (exit == 0 || levels_[exit - 1].height != height) return normal_of(levels_[exit].id);
  least_normal_ = Int3(INT32_MAX);
  for (std::uint32_t i = exit + 1; i-- > 0 && levels_[i].height == height;) {
    const Int3& m = normal_of(levels_[i].id);
    if (less(m, least_normal_)) least_normal_ = m;
  }
  return least_normal_;
}

/// H_0 of a sample on a static triangle whose ray leaves the tool through a face with the direction m: how much further, in height, the next
/// sample of the grid lies on the same two faces. `d` is n_c.
std::uint32_t HostHeights::fade_height(std::uint32_t static_id, const Int3& d, const Int3& m) const {
  const LatticeMesh& mesh = geometry_->mockup;
  const std::int64_t leaving = std::abs(std::int64_t{m.x} * d.x + std::int64_t{m.y} * d.y + std::int64_t{m.z} * d.z) >> 28;
  if (leaving == 0) return static_cast<std::uint32_t>(most_fade_);
  const Int3 n = mesh.unit_normal_q30[static_id];
  const int k = mesh.sample_axis[static_id];
  const auto apart = [&](int w) { return std::abs(std::int64_t{m[w]} * n[k] - std::int64_t{m[k]} * n[w]); };   // within 2^60
  const std::int64_t along = std::max(apart((k + 1) % 3), apart((k + 2) % 3)) / std::abs(std::int64_t{n[k]});   // |n_k| ≥ 2^30 / √3
  return static_cast<std::uint32_t>(std::min(most_fade_, 4 * std::int64_t{geometry_->sample_spacing} * along / leaving));   // spacing ≤ 2^28
}

std::uint32_t HostHeights::fade_of(std::uint32_t static_id, const Int3& d, const Int3& m) {
  if (static_id != faded_ || m != faded_m_ || d != faded_d_) {
    fade_ = fade_height(static_id, d, m);
    faded_ = static_id;
    faded_m_ = m;
    faded_d_ = d;
  }
  return fade_;
}

// H ≤ 2^31 and w < 2^31: M = (H·w) >> 30 ≤ 2^32, M·s within 2^60; w' < 2^32. Faded heights are w·H or w·H_0·ν ≤ 2^62.6.
void HostHeights::add(AreaWork& area, const Int3& point, std::uint32_t height, std::uint32_t w, std::uint32_t fade) {
  const auto m = static_cast<std::int64_t>(std::uint64_t{height} * w >> 30);
  area.rays += 1;
  area.max_height = std::max(area.max_height, height);
  area.height_sum += m;
  for (int k = 0; k < 3; ++k) {
    const std::int64_t moment = m * point[k];
    area.moment_low[k] += moment & 0xFFFFFFFF;
    area.moment_high[k] += moment >> 32;
  }

  const std::int64_t whole = w;
  std::int64_t weight = whole, slope = whole, faded = static_cast<std::int64_t>(std::uint64_t{height} * w >> 10);   // faded: Q20
  if (fade >= kLeastFade && height / 3 < fade) {   // H < 3 H_0: floor(H/3) < H_0
    const std::int64_t one = std::int64_t{1} << 18, t = static_cast<std::int64_t>((std::uint64_t{height} << 18) / fade);   // Q18, below 3
    // 2φ in Q36, 2φ' in Q18, 12ν in Q54. Every term is below 2^63.
    std::int64_t value = 0, rate = 0, deep = 0;
    if (height < fade) {
      value = 2 * t * t;
      rate = 4 * t;
      deep = 8 * t * t * t;
    } else if (height - fade < fade) {
      value = t * (10 * one - 3 * t) - 5 * one * one;
      rate = 10 * one - 6 * t;
      deep = t * (t * (45 * one - 12 * t) - 30 * one * one) + 5 * one * one * one;
    } else {
      value = t * (t - 6 * one) + 11 * one * one;
      rate = 2 * t - 6 * one;
      deep = t * (t * (4 * t - 27 * one) + 66 * one * one) - 27 * one * one * one;
    }
    weight = whole * (value >> 6) >> 31;                // w < 2^31, 2φ < 2^32 in Q30
    const std::int64_t size = whole * std::abs(rate) >> 18;   // |2φ'| ≤ 4
    const std::int64_t bend = size * t >> 20, step = (size << 9) / fade;
    slope = rate < 0 ? weight - bend : weight + bend;
    area.weight_slope += rate < 0 ? -step : step;
    const std::int64_t down = fade * ((deep >> 24) / 12) >> 20;   // H_0·ν, Q10: H_0 ≤ 2^30, ν ≤ 3 in Q30
    faded = whole * (down >> 20) + (whole * (down & 0xFFFFF) >> 20);
  }
  area.weight_sum += weight;
  area.faded_sum += faded >> 20;
  area.faded_rest += faded & 0xFFFFF;
  area.height_slope += slope;
}

bool HostHeights::sum(PosedTool& tool, const ContactLists& lists, const HostAreas& areas, std::vector<RisenSample>& risen) {
  const NearRays::Turn turn(tool.pose());
  left_ = kNone;
  // Area by area, for an area's rays have one direction.
  first_of_.assign(kMaxFrameAreas + 1, 0);
  area_of_.clear();
  for (const FrameSample& sample : lists.samples) {
    area_of_.push_back(areas.area_of(sample.static_id, lists));
    first_of_[area_of_.back() + 1] += 1;
  }
  for (std::size_t i = 0; i < kMaxFrameAreas; ++i) first_of_[i + 1] += first_of_[i];
  by_area_.resize(lists.samples.size());
  for (std::uint32_t i = 0; i < lists.samples.size(); ++i) by_area_[first_of_[area_of_[i]]++] = i;

  // first_of_ has moved: an area's samples begin where the area before has ended.
  std::uint32_t begin = 0;
  for (std::uint32_t number = 0; number < kMaxFrameAreas; ++number) {
    const std::span<const std::uint32_t> own(by_area_.data() + begin, first_of_[number] - begin);
    begin = first_of_[number];
    if (own.empty()) continue;
    AreaWork& area = lists.areas[number];
    if (area.direction == Int3(0)) continue;
    points_.clear();
    for (const std::uint32_t i : own) points_.push_back(lists.samples[i].point);
    aim(turn, -area.direction);
    const Int3 size = glm::abs(area.direction);
    most_fade_ = std::min((std::int64_t{geometry_->sample_spacing} << 32) / std::max({size.x, size.y, size.z}), std::int64_t{1} << 30);
    const bool together = packet_.trace(tool, points_, along_);
    for (std::size_t k = 0; k < own.size(); ++k) {
      if (together) {
        levels_.clear();
        packet_.for_hits(k, [&](const RayPacket::Hit& hit) {
          if (hit.sign == 0)
            cross(tool, points_[k], hit.id, kNone);
          else
            levels_.push_back({hit.height, hit.sign, hit.id});
        });
      } else if (!walk(tool, turn, points_[k], false)) {
        return false;
      }
      const std::uint32_t exit = lowest_exit();
      if (exit == kNone) continue;
      const std::uint32_t h = levels_[exit].height;
      const std::uint32_t id = lists.samples[own[k]].static_id;
      add(area, points_[k], h, geometry_->mockup.sample_weight_q30[id], fade_of(id, area.direction, exit_normal(tool, exit)));
      risen.emplace_back(number, points_[k], h);
    }
  }
  return true;
}

}  // namespace palpate

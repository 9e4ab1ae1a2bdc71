#include "compute/frame_decode.h"

#include <algorithm>
#include <array>
#include <numeric>
#include <span>
#include <tuple>

#include "compute/frame_capacity.h"

namespace palpate {
namespace {

using namespace gpu;   // names of shaders/shared/frame.h

/// Whether all that overflowed, if anything, comes after the sets: lists of areas, tables of the response.
bool sets_are_whole(const FrameState& state) {
  constexpr std::uint32_t kAfterSets = 1u << kListMembers | 1u << kListPierces | ~0u << kListResponseFirst;
  return (state.overflow & ~kAfterSets) == 0 && (state.overflow_other & (kOverflowBins | kOverflowLoop)) == 0;
}

void sort_ids(std::vector<std::uint32_t>& ids) { std::sort(ids.begin(), ids.end()); }

void decode_sets(const FrameOutput& output, Contacts& out) {
  for (const StaticResult& s : std::span(output.statics, output.result->static_count)) {
    if ((s.state & kStaticHit) != 0) {
      out.cst.push_back(s.id);
      continue;
    }
    if ((s.state & kStaticListed) != 0) out.bst.push_back(s.id);
    if ((s.state & kStaticSampled) != 0) out.est.push_back(s.id);
  }
  for (const MobileResult& m : std::span(output.mobiles, output.result->mobile_count))
    ((m.state & kMobileHit) != 0 ? out.cmt : (m.state & kMobileInternal) != 0 ? out.imt : out.bmt).push_back(m.id);
  for (auto* ids : {&out.cst, &out.bst, &out.est, &out.cmt, &out.bmt, &out.imt}) sort_ids(*ids);
}

void decode_sums(const AreaResult& from, bool points, ContactArea& area) {
  area.id = from.id;
  area.flags = from.flags;
  area.direction = from.direction;
  area.sheet_sign = static_cast<std::int8_t>(from.sheet_sign);
  area.rays = from.rays;
  area.max_height = from.max_height;
  area.height_sum = points ? from.height_sum : 0;
  area.weight_sum = from.weight_sum;
  area.faded_sum = from.faded_sum;
  area.faded_rest = from.faded_rest;
  area.weight_slope = from.weight_slope;
  area.height_slope = from.height_slope;
  for (std::size_t k = 0; k < 3; ++k) {
    area.moment[k] = points ? WideSum{from.moment_low[k], from.moment_high[k]} : WideSum{};
    area.voxel_sum[k] = points ? from.voxel_sum[k] : 0;
  }
  area.voxel_count = points ? from.voxel_count : 0;
}

void decode_areas(const FrameOutput& output, Contacts& out) {
  const FrameResult& result = *output.result;
  const std::uint32_t count = std::min(result.area_count, kMaxFrameAreas);
  std::array<std::uint32_t, kMaxFrameAreas> order{}, position{};
  std::iota(order.begin(), order.begin() + count, 0u);
  std::sort(order.begin(), order.begin() + count, [&](auto a, auto b) { return result.areas[a].id < result.areas[b].id; });
  for (std::uint32_t i = 0; i < count; ++i) position[order[i]] = i;

  out.areas.resize(count);
  for (std::uint32_t i = 0; i < count; ++i) {
    ContactArea& area = out.areas[i];
    decode_sums(result.areas[order[i]], out.contact_points, area);
    area.static_ids.clear();
    area.mobile_ids.clear();
    area.zones.clear();
    area.pierces.clear();
  }

  const auto arrange = [&] {
    for (const AreaPierce& p : std::span(output.pierces, result.pierce_count)) out.areas[position[p.area]].pierces.push_back(position[p.pierced]);
    for (ContactArea& area : out.areas) {
      sort_ids(area.static_ids);
      sort_ids(area.mobile_ids);
      sort_ids(area.pierces);
      std::sort(area.zones.begin(), area.zones.end(), [](const auto& a, const auto& b) { return a.front() < b.front(); });
    }
  };
  if (!out.lists) {   // the next frame holds on to an area by its static triangles
    for (const StaticResult& s : std::span(output.statics, result.static_count))
      if (s.area < count) out.areas[position[s.area]].static_ids.push_back(s.id);
    return arrange();
  }

  // Static triangles by area, zone, id; a new zone begins where its label changes.
  struct Place {
    std::uint32_t area, zone, id;
  };
  std::vector<Place> places;
  for (const StaticResult& s : std::span(output.statics, result.static_count))
    if (s.area < count) places.push_back({position[s.area], s.zone, s.id});
  std::sort(places.begin(), places.end(), [](const Place& a, const Place& b) { return std::tie(a.area, a.zone, a.id) < std::tie(b.area, b.zone, b.id); });
  for (std::size_t i = 0; i < places.size(); ++i) {
    ContactArea& area = out.areas[places[i].area];
    if (i == 0 || places[i - 1].area != places[i].area || places[i - 1].zone != places[i].zone) area.zones.emplace_back();
    area.zones.back().push_back(places[i].id);
    area.static_ids.push_back(places[i].id);
  }

  for (const AreaMember& m : std::span(output.members, result.member_count)) out.areas[position[m.area]].mobile_ids.push_back(m.mobile);
  arrange();
}

}  // namespace

void clear(Contacts& out) {
  out.contact = false;
  out.truncated = false;
  out.truncated_capacity = "";
  out.pairs = 0;
  for (auto* ids : {&out.cst, &out.bst, &out.est, &out.cmt, &out.bmt, &out.imt}) ids->clear();
  out.areas.clear();
  out.flags = 0;
  out.swallowed_direction = Int3(0);
  out.swallowed_height = 0;
}

void decode(const FrameOutput& output, Contacts& out) {
  clear(out);
  const FrameResult& result = *output.result;
  out.truncated = (result.state.overflow | result.state.overflow_other) != 0;
  if (out.truncated) out.truncated_capacity = overflow_name(result.state);
  if (!sets_are_whole(result.state)) return;
  out.contact = result.state.contact != 0;
  out.pairs = result.pair_count;
  if (out.lists) decode_sets(output, out);
  if (!out.contact || out.truncated) return;
  out.flags = result.flags;
  out.swallowed_direction = result.swallowed_direction;
  out.swallowed_height = result.swallowed_height;
  decode_areas(output, out);
}

}  // namespace palpate

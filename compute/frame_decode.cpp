#include "compute/frame_decode.h"

#include <algorithm>
#include <array>
#include <numeric>
#include <span>

#include "compute/frame_capacity.h"
#include "compute/sort_keys.h"

namespace palpate {
namespace {

using namespace gpu;   // names of shaders/shared/frame.h

constexpr std::size_t kMostSpareZones = 4096;   // whose memory is kept (chosen)

/// Whether all that overflowed, if anything, comes after the sets: lists of areas, tables of the response.
bool sets_are_whole(const FrameState& state) {
  constexpr std::uint32_t kAfterSets = 1u << kListMembers | 1u << kListPierces | ~0u << kListResponseFirst;
  return (state.overflow & ~kAfterSets) == 0 && (state.overflow_other & (kOverflowBins | kOverflowLoop)) == 0;
}

/// Entries by id: id · 2^32 + place, ascending. The host's are so already.
template <class Entry, class Id>
void order_by_id(std::span<const Entry> entries, Id id, std::vector<std::uint64_t>& out, std::vector<std::uint64_t>& spare) {
  out.resize(entries.size());
  bool ascending = true;
  for (std::uint32_t i = 0; i < entries.size(); ++i) {
    out[i] = std::uint64_t{id(entries[i])} << 32 | i;
    ascending = ascending && (i == 0 || out[i - 1] < out[i]);
  }
  if (!ascending) sort_keys(out, spare);
}

/// Of keys made by order_by_id().
void append_ids(std::vector<std::uint32_t>& to, std::span<const std::uint64_t> keys) {
  const std::size_t at = to.size();
  to.resize(at + keys.size());
  for (std::size_t i = 0; i < keys.size(); ++i) to[at + i] = static_cast<std::uint32_t>(keys[i] >> 32);
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

}  // namespace

void FrameDecoder::decode_sets(const FrameOutput& output, Contacts& out) {
  const std::span statics(output.statics, output.result->static_count);
  order_by_id(statics, [](const StaticResult& s) { return s.id; }, statics_, spare_keys_);
  if (!out.lists) return;
  for (const std::uint64_t key : statics_) {
    const StaticResult& s = statics[static_cast<std::uint32_t>(key)];
    if ((s.state & kStaticHit) != 0) {
      out.cst.push_back(s.id);
      continue;
    }
    if ((s.state & kStaticListed) != 0) out.bst.push_back(s.id);
    if ((s.state & kStaticSampled) != 0) out.est.push_back(s.id);
  }
  const std::span mobiles(output.mobiles, output.result->mobile_count);
  order_by_id(mobiles, [](const MobileResult& m) { return m.id; }, mobiles_, spare_keys_);
  for (const std::uint64_t key : mobiles_) {
    const MobileResult& m = mobiles[static_cast<std::uint32_t>(key)];
    ((m.state & kMobileHit) != 0 ? out.cmt : (m.state & kMobileInternal) != 0 ? out.imt : out.bmt).push_back(m.id);
  }
}

/// One more zone of an area, empty.
std::vector<std::uint32_t>& FrameDecoder::new_zone(ContactArea& area) {
  if (spare_zones_.empty()) return area.zones.emplace_back();
  area.zones.push_back(std::move(spare_zones_.back()));
  spare_zones_.pop_back();
  return area.zones.back();
}

void FrameDecoder::decode_areas(const FrameOutput& output, Contacts& out) {
  const FrameResult& result = *output.result;
  const std::uint32_t count = std::min(result.area_count, kMaxFrameAreas);
  std::array<std::uint32_t, kMaxFrameAreas> order{}, position{};
  std::iota(order.begin(), order.begin() + count, 0u);
  std::sort(order.begin(), order.begin() + count, [&](auto a, auto b) { return result.areas[a].id < result.areas[b].id; });
  for (std::uint32_t i = 0; i < count; ++i) {
    position[order[i]] = i;
    if (!spare_areas_.empty()) {
      out.areas.push_back(std::move(spare_areas_.back()));
      spare_areas_.pop_back();
    } else {
      out.areas.emplace_back();
    }
    decode_sums(result.areas[order[i]], out.contact_points, out.areas.back());
  }

  // In the order of ids: every list ascends, and zones come by their first ids. A zone's label is the place of one of its triangles.
  zone_of_.assign(result.static_count, kNone);
  const auto at = [&](std::size_t i) -> const StaticResult& { return output.statics[static_cast<std::uint32_t>(statics_[i])]; };
  for (std::size_t begin = 0, end; begin < statics_.size(); begin = end) {
    // Triangles of a zone mostly follow each other.
    const StaticResult& first = at(begin);
    for (end = begin + 1; end < statics_.size() && at(end).zone == first.zone;) ++end;
    if (first.area >= count) continue;
    const std::span run(statics_.data() + begin, end - begin);
    ContactArea& area = out.areas[position[first.area]];
    append_ids(area.static_ids, run);   // the next frame holds on to an area by them
    if (!out.lists) continue;
    std::uint32_t& zone = zone_of_[first.zone];
    if (zone == kNone) {
      zone = static_cast<std::uint32_t>(area.zones.size());
      new_zone(area);
    }
    append_ids(area.zones[zone], run);
  }
  const std::span members(output.members, out.lists ? result.member_count : 0);
  order_by_id(members, [](const AreaMember& m) { return m.mobile; }, members_, spare_keys_);
  for (const std::uint64_t key : members_) {
    const AreaMember& m = members[static_cast<std::uint32_t>(key)];
    out.areas[position[m.area]].mobile_ids.push_back(m.mobile);
  }
  for (const AreaPierce& p : std::span(output.pierces, result.pierce_count)) out.areas[position[p.area]].pierces.push_back(position[p.pierced]);
  for (ContactArea& area : out.areas) std::sort(area.pierces.begin(), area.pierces.end());
}

void FrameDecoder::clear(Contacts& out) {
  out.contact = false;
  out.truncated = false;
  out.truncated_capacity = "";
  out.pairs = 0;
  for (auto* ids : {&out.cst, &out.bst, &out.est, &out.cmt, &out.bmt, &out.imt}) ids->clear();
  for (ContactArea& area : out.areas) {
    for (std::vector<std::uint32_t>& zone : area.zones) {
      zone.clear();
      if (spare_zones_.size() < kMostSpareZones) spare_zones_.push_back(std::move(zone));
    }
    for (auto* ids : {&area.static_ids, &area.mobile_ids, &area.pierces}) ids->clear();
    area.zones.clear();
    if (spare_areas_.size() < kMaxFrameAreas) spare_areas_.push_back(std::move(area));
  }
  out.areas.clear();
  out.flags = 0;
  out.swallowed_direction = Int3(0);
  out.swallowed_height = 0;
}

void FrameDecoder::decode(const FrameOutput& output, Contacts& out) {
  clear(out);
  const FrameResult& result = *output.result;
  out.truncated = (result.state.overflow | result.state.overflow_other) != 0;
  if (out.truncated) out.truncated_capacity = overflow_name(result.state);
  if (!sets_are_whole(result.state)) return;
  out.contact = result.state.contact != 0;
  out.pairs = result.pair_count;
  decode_sets(output, out);
  if (!out.contact || out.truncated) return;
  out.flags = result.flags;
  out.swallowed_direction = result.swallowed_direction;
  out.swallowed_height = result.swallowed_height;
  decode_areas(output, out);
}

}  // namespace palpate

#include "compute/gpu/frame/decode.h"

#include <algorithm>
#include <array>
#include <numeric>
#include <span>

#include "compute/gpu/frame/capacity.h"
#include "compute/gpu/frame/sort_keys.h"

namespace palpate {
namespace {

using namespace gpu;  // names of shaders/shared/frame.h

constexpr std::size_t kMostSpareZones = 4096;  // whose memory is kept (chosen)

/// Whether all that overflowed, if anything, comes after the sets: lists of areas, tables of the response.
bool sets_are_whole(const FrameState& state) {
  static_assert(kOverflowAfterSets == (1u << kListMembers | ~0u << kListResponseFirst));
  return (state.overflow & ~kOverflowAfterSets) == 0 && (state.overflow_other & kOverflowLoop) == 0;
}

void append_ids(std::vector<std::uint32_t>& to, std::span<const StaticResult> statics) {
  const std::size_t at = to.size();
  to.resize(at + statics.size());
  for (std::size_t i = 0; i < statics.size(); ++i) to[at + i] = statics[i].id;
}

void decode_sums(const AreaResult& from, bool points, ContactArea& area) {
  area.id = from.id;
  area.flags = from.flags;
  area.direction = from.direction;
  area.rays = from.rays;
  area.max_height = from.max_height;
  area.height_sum = from.height_sum;
  for (std::size_t k = 0; k < 3; ++k) area.voxel_sum[k] = points ? from.voxel_sum[k] : 0;
  area.voxel_count = points ? from.voxel_count : 0;
}

}  // namespace

/// Entries by ascending id, equal ones as they came: themselves where they are so already, as the host's are,
/// else a copy in `sorted`.
template <class Entry, class Id>
std::span<const Entry> FrameDecoder::by_id(std::span<const Entry> entries, Id id,
                                           std::vector<Entry>& sorted) {
  if (std::is_sorted(entries.begin(), entries.end(),
                     [&](const Entry& a, const Entry& b) { return id(a) < id(b); }))
    return entries;
  keys_.resize(entries.size());
  for (std::size_t i = 0; i < entries.size(); ++i) keys_[i] = std::uint64_t{id(entries[i])} << 32 | i;
  sort_keys(keys_, spare_keys_);
  sorted.resize(entries.size());
  for (std::size_t i = 0; i < entries.size(); ++i) sorted[i] = entries[static_cast<std::uint32_t>(keys_[i])];
  return sorted;
}

void FrameDecoder::decode_sets(const FrameOutput& output, Contacts& out) {
  statics_ = by_id(
      std::span(output.statics, output.result->static_count), [](const StaticResult& s) { return s.id; },
      sorted_statics_);
  if (!out.lists) return;
  for (const StaticResult& s : statics_) {
    if ((s.state & kStaticHit) != 0) {
      out.cst.push_back(s.id);
      continue;
    }
    if ((s.state & kStaticListed) != 0) out.bst.push_back(s.id);
    if ((s.state & kStaticSampled) != 0) out.est.push_back(s.id);
  }
  const std::span mobiles(output.mobiles, output.result->mobile_count);
  for (const MobileResult& m : by_id(
           mobiles, [](const MobileResult& one) { return one.id; }, sorted_mobiles_))
    ((m.state & kMobileHit) != 0        ? out.cmt
     : (m.state & kMobileInternal) != 0 ? out.imt
                                        : out.bmt)
        .push_back(m.id);
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
  std::sort(order.begin(), order.begin() + count,
            [&](auto a, auto b) { return result.areas[a].id < result.areas[b].id; });
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

  // In the order of ids: every list ascends, and zones come by their first ids. A zone's label is the place
  // of one of its triangles.
  zone_of_.assign(result.static_count, kNone);
  for (std::size_t begin = 0, end; begin < statics_.size(); begin = end) {
    // Triangles of a zone mostly follow each other.
    const StaticResult& first = statics_[begin];
    for (end = begin + 1; end < statics_.size() && statics_[end].zone == first.zone;) ++end;
    if (first.area >= count) continue;
    const std::span run = statics_.subspan(begin, end - begin);
    ContactArea& area = out.areas[position[first.area]];
    append_ids(area.static_ids, run);
    if (!out.lists) continue;
    std::uint32_t& zone = zone_of_[first.zone];
    if (zone == kNone) {
      zone = static_cast<std::uint32_t>(area.zones.size());
      new_zone(area);
    }
    append_ids(area.zones[zone], run);
  }
  const std::span members(output.members, out.lists ? result.member_count : 0);
  for (const AreaMember& m : by_id(
           members, [](const AreaMember& one) { return one.mobile; }, sorted_members_))
    out.areas[position[m.area]].mobile_ids.push_back(m.mobile);
}

void FrameDecoder::clear(Contacts& out) {
  out.contact = false;
  out.truncated = false;
  out.truncated_capacity = "";
  out.pairs = 0;
  for (auto* ids : {&out.cst, &out.bst, &out.est, &out.cmt, &out.bmt, &out.imt}) ids->clear();
  // The last first, so that the next frame's first area, which is mostly this one's, takes what this one's
  // had and does not grow.
  for (auto area = out.areas.rbegin(); area != out.areas.rend(); ++area) {
    for (auto zone = area->zones.rbegin(); zone != area->zones.rend(); ++zone) {
      zone->clear();
      if (spare_zones_.size() < kMostSpareZones) spare_zones_.push_back(std::move(*zone));
    }
    for (auto* ids : {&area->static_ids, &area->mobile_ids}) ids->clear();
    area->zones.clear();
    if (spare_areas_.size() < kMaxFrameAreas) spare_areas_.push_back(std::move(*area));
  }
  out.areas.clear();
  out.flags = 0;
  out.field = {};
  out.carriers.clear();
  out.ignored_touched.clear();
}

void FrameDecoder::decode(const FrameOutput& output, Contacts& out) {
  clear(out);
  const FrameResult& result = *output.result;
  out.truncated = (result.state.overflow | result.state.overflow_other) != 0;
  if (out.truncated) out.truncated_capacity = overflow_name(result.state);
  if (!sets_are_whole(result.state)) return;
  out.contact = result.state.contact != 0;
  out.pairs = result.pair_count;
  if (out.lists || output.areas) decode_sets(output, out);
  if (!out.contact || out.truncated) return;
  if (output.areas) decode_areas(output, out);
}

}  // namespace palpate

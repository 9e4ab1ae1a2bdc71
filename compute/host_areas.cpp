#include "compute/host_areas.h"

#include <algorithm>
#include <bit>
#include <cstdlib>
#include <cstring>

#include "compute/host_exact.h"
#include "compute/nearest_external.h"
#include "compute/processor.h"

namespace palpate {
namespace {

using namespace gpu;   // names of shaders/shared/frame.h
__extension__ using Wide = __int128;
using Sum = std::array<std::int64_t, 3>;

constexpr std::int64_t kMostGridPoints = 4096;   // of one tool triangle, beyond which the device takes over (chosen)
constexpr std::size_t kMostListed = 1u << 19;    // samples of a tool, 6 MiB: beyond, they are worked out when asked for (chosen)
constexpr std::uint32_t kAhead = 8;              // triangles whose data are called for before their turn: they lie far apart (chosen)

std::int64_t floor_div(std::int64_t a, std::int64_t b) {   // b > 0
  const std::int64_t q = a / b;
  return q - (a % b < 0 ? 1 : 0);
}

std::int64_t squared(const Int3& v) {
  return std::int64_t{v.x} * v.x + std::int64_t{v.y} * v.y + std::int64_t{v.z} * v.z;
}

Sum sum_of(const std::int64_t (&a)[3]) { return {a[0], a[1], a[2]}; }

Sum with_sheets(const std::int64_t (&fixed)[3], const std::int64_t (&sheet)[3], std::int32_t sign) {
  Sum out;
  for (std::size_t k = 0; k < 3; ++k) out[k] = fixed[k] + (sign < 0 ? -sheet[k] : sheet[k]);
  return out;
}

Sum static_sum(const AreaWork& area) { return with_sheets(area.fixed_sum, area.sheet_sum, area.sheet_sign); }

/// Over CST alone, for areas without counting samples.
Sum bare_sum(const AreaWork& area) { return area.samples != 0 ? Sum{} : with_sheets(area.bare_fixed, area.bare_sheet, area.sheet_sign); }

std::int64_t largest(const Sum& s) { return std::max({std::abs(s[0]), std::abs(s[1]), std::abs(s[2])}); }

/// A sum that has not cancelled.
bool usable(const Sum& s, std::int64_t weight) {
  const std::int64_t m = largest(s);
  return m != 0 && 8 * m >= weight;
}

/// Shifted until the largest component is in [2^28, 2^29), towards 0.
Int3 normalise(const Sum& s) {
  const int k = 28 - (63 - std::countl_zero(static_cast<std::uint64_t>(largest(s))));
  Int3 out;
  for (std::size_t i = 0; i < 3; ++i) {
    const std::int64_t size = k >= 0 ? std::abs(s[i]) << k : std::abs(s[i]) >> -k;
    out[static_cast<int>(i)] = static_cast<std::int32_t>(s[i] < 0 ? -size : size);
  }
  return out;
}

/// The first place of a place's set.
std::uint32_t first_of(std::vector<std::uint32_t>& sets, std::uint32_t place) {
  while (sets[place] != place) place = sets[place] = sets[sets[place]];
  return place;
}

/// Joins the set whose first place is `first` with that of `other`: the first place of both.
std::uint32_t joined(std::vector<std::uint32_t>& sets, std::uint32_t first, std::uint32_t other) {
  if (sets[other] == first) return first;
  other = first_of(sets, other);
  const std::uint32_t least = std::min(first, other);
  sets[std::max(first, other)] = least;
  return least;
}

void begin(AreaWork& area, std::uint32_t id) {
  std::memset(static_cast<void*>(&area), 0, sizeof area);
  area.box_low = Int3(INT32_MAX);
  area.box_high = Int3(-INT32_MAX);
  area.id = id;
  area.held_area = kNone;
}

}  // namespace

Result<HostAreas> HostAreas::make(VulkanDevice& device, const SceneGeometry& geometry, const PreparedScene& scene, std::size_t most_statics, bool zones) {
  HostAreas out;
  out.split_ = zones;
  out.geometry_ = &geometry;
  out.constants_ = scene.constants;
  out.per_voxel_ = 1.0 / scene.constants.mockup.grid.size;
  const std::size_t triangles = geometry.mockup.triangles.size();
  const PartitionBuffers& p = scene.mockup.partition;
  const Int3 n = p.grid.bricks;
  if (auto r = out.seam_begin_.read(device, scene.mockup.seam_begin, scene.mockup.seam_begin.bytes() / 4); !r) return r.error();
  if (auto r = out.seams_.read(device, scene.mockup.seams, scene.mockup.seam_entries); !r) return r.error();
  if (auto r = out.brick_slots_.read(device, p.brick_slot, static_cast<std::size_t>(n.x) * static_cast<std::size_t>(n.y) * static_cast<std::size_t>(n.z)); !r)
    return r.error();
  if (auto r = out.bricks_.read(device, p.bricks, p.grid.mixed_bricks); !r) return r.error();
  out.sheets_ = std::any_of(geometry.mockup.flags.begin(), geometry.mockup.flags.end(), [](std::uint8_t flags) { return (flags & kTriangleSheet) != 0; });
  out.has_seams_.resize((triangles + 63) / 64);
  for (std::uint32_t id = 0; id < triangles; ++id)
    if (out.seam_begin_[id] != out.seam_begin_[id + 1]) out.has_seams_[id >> 6] |= std::uint64_t{1} << (id & 63);
  out.most_statics_ = most_statics;
  out.marks_.resize(triangles);
  for (auto* table : {&out.slot_at_, &out.zone_, &out.area_}) table->resize(std::min(triangles, most_statics));
  for (auto* table : {&out.common_, &out.most_common_}) table->resize(kMaxFrameAreas);
  out.spheres_.resize(kMaxFrameAreas);
  out.list_tool_samples();
  return out;
}

/// The slot of a static triangle, kNone if it is not in C_s.
std::uint32_t HostAreas::slot(std::uint32_t id, const ContactLists& lists) const {
  const std::uint32_t place = marks_.place(id);
  return place == IdMarks::kNowhere ? kNone : slot_at(place, lists);
}

/// Where C_s comes in any order.
void HostAreas::number(const ContactLists& lists) {
  marks_.clear();
  for (const StaticResult& result : lists.statics) marks_.add(result.id, 1);
  marks_.number([](std::uint32_t, std::uint32_t) {});
  for (std::uint32_t i = 0; i < lists.statics.size(); ++i) slot_at_[marks_.place(lists.statics[i].id)] = i;
}

/// Zones and areas of all places. A set is named by its first place, so that on the way to it places descend.
void HostAreas::join_all(const ContactLists& lists) {
  const LatticeMesh& mesh = geometry_->mockup;
  const auto count = static_cast<std::uint32_t>(lists.statics.size());
  const auto id_at = [&](std::uint32_t place) { return lists.statics[slot_at(place, lists)].id; };
  edges_.clear();
  for (std::uint32_t i = 0; i < count; ++i) {
    const std::uint32_t id = id_at(i);
    if (i + 2 * kAhead < count) {
      const std::uint32_t later = id_at(i + 2 * kAhead);
      __builtin_prefetch(&mesh.neighbour_begin[later]);
      __builtin_prefetch(&mesh.triangles[later]);
    }
    if (i + kAhead < count) {
      const std::uint32_t later = id_at(i + kAhead);
      __builtin_prefetch(mesh.neighbours.data() + mesh.neighbour_begin[later]);
      for (const std::uint32_t vertex : mesh.triangles[later]) __builtin_prefetch(&mesh.vertices[vertex]);   // for gather()
    }
    zone_[i] = i;
    std::uint32_t own = i;   // the first place of its zone so far
    // Ascending: beyond its own number the others join from their side.
    for (std::uint32_t e = mesh.neighbour_begin[id]; e < mesh.neighbour_begin[id + 1] && mesh.neighbours[e] >> 1 < id; ++e) {
      const std::uint32_t to = marks_.place(mesh.neighbours[e] >> 1);
      if (to == IdMarks::kNowhere) continue;
      if (split_ && (mesh.neighbours[e] & 1) == 0)
        edges_.emplace_back(i, to);
      else
        own = joined(zone_, own, to);
    }
    // Seams are smooth by definition.
    if ((has_seams_[id >> 6] >> (id & 63) & 1) == 0) continue;
    for (std::uint32_t e = seam_begin_[id]; e < seam_begin_[id + 1] && seams_[e] < id; ++e) {
      const std::uint32_t to = marks_.place(seams_[e]);
      if (to != IdMarks::kNowhere) own = joined(zone_, own, to);
    }
  }
  for (std::uint32_t i = 0; i < count; ++i) area_[i] = zone_[i] = zone_[zone_[i]];
  for (const auto& [a, b] : edges_) joined(area_, first_of(area_, a), b);
  if (!edges_.empty())
    for (std::uint32_t i = 0; i < count; ++i) area_[i] = area_[area_[i]];
}

/// Counting samples of every slot.
void HostAreas::count_samples(const ContactLists& lists) const {
  for (std::uint32_t i = 0; i < lists.statics.size(); ++i) lists.slots[i] = {kNone, 0};
  std::uint32_t id = kNone, at = 0;   // samples of a triangle follow each other
  for (const FrameSample& sample : lists.samples) {
    if (sample.static_id != id) at = slot(id = sample.static_id, lists);
    lists.slots[at].samples += 1;
  }
}

/// Numbers the areas by their smallest ids; every slot adds its triangle to its own. False: too many areas.
bool HostAreas::gather(const ContactLists& lists, Answer& answer) const {
  const LatticeMesh& mesh = geometry_->mockup;
  const auto count = static_cast<std::uint32_t>(lists.statics.size());
  std::uint32_t number = kNone;   // of the area that `box` grows for: triangles of an area mostly follow each other
  exact::Box box{};
  const auto grow_area = [&] {
    if (number == kNone) return;
    lists.areas[number].box_low = glm::min(lists.areas[number].box_low, box.low);
    lists.areas[number].box_high = glm::max(lists.areas[number].box_high, box.high);
  };
  for (std::uint32_t i = 0; i < count; ++i) {
    SlotWork& slot = lists.slots[slot_at(i, lists)];
    StaticResult& result = lists.statics[slot_at(i, lists)];
    const std::uint32_t id = result.id;
    if (area_[i] == i) {
      if (answer.areas == kMaxFrameAreas) return false;
      slot.area = answer.areas++;
      begin(lists.areas[slot.area], id);
    } else {
      slot.area = lists.slots[slot_at(area_[i], lists)].area;
    }
    result.area = slot.area;
    result.zone = slot_at(zone_[i], lists);
    const exact::Corners corners{mesh.corner(id, 0), mesh.corner(id, 1), mesh.corner(id, 2)};
    const exact::Box own = exact::box_of(corners);
    if (slot.area == number) {
      box = {glm::min(box.low, own.low), glm::max(box.high, own.high)};
    } else {
      grow_area();
      number = slot.area;
      box = own;
    }
    AreaWork& area = lists.areas[number];
    area.statics += 1;
    if (zone_[i] == i) area.zones += 1;
    const bool hit = (result.state & kStaticHit) != 0, sheet = sheets_ && (mesh.flags[id] & kTriangleSheet) != 0;
    if (!hit && !sheet && slot.samples == 0) continue;   // adds no normal
    if (hit) area.cst += 1;
    if (sheet) area.sheets += 1;
    // A term (w·n̂) >> 30 is within 2^31, a triangle's samples within 2^32: the sums stay within 2^63 for 2^32 samples in all.
    const auto w = static_cast<std::int64_t>(mesh.sample_weight_q30[id]);
    for (std::size_t k = 0; k < 3; ++k) {
      const std::int64_t n = mesh.unit_normal_q30[id][static_cast<int>(k)];
      (sheet ? area.sheet_sum : area.fixed_sum)[k] += std::int64_t{slot.samples} * ((w * n) >> 30);
      if (hit) (sheet ? area.bare_sheet : area.bare_fixed)[k] += n;
      if (sheet) area.sheet_side[k] += n;
    }
    area.samples += slot.samples;
    area.static_weight += std::int64_t{slot.samples} * w;
  }
  grow_area();
  return true;
}

/// Gives every tool triangle of C_m to the areas whose spheres hold its rounded centroid, else to the nearest.
bool HostAreas::associate(PosedTool& tool, const ContactLists& lists, Answer& answer) {
  for (std::uint32_t number = 0; number < answer.areas; ++number) {
    const AreaWork& area = lists.areas[number];
    spheres_[number] = {area.box_low + area.box_high, squared(area.box_high - area.box_low)};
  }
  for (const MobileResult& mobile : lists.mobiles) {
    const exact::Corners& t = tool.corners(mobile.id);
    const Int3 sum = t[0] + t[1] + t[2];
    const Int3 g(floor_div(sum.x, 3), floor_div(sum.y, 3), floor_div(sum.z, 3));
    const std::uint32_t members = answer.members;
    const auto distance = [&](std::uint32_t number) { return squared(2 * g - spheres_[number].centre); };   // components within 2^30
    for (std::uint32_t number = 0; number < answer.areas; ++number) {
      if (distance(number) > spheres_[number].reach) continue;
      if (answer.members == lists.members.size()) return false;
      lists.members[answer.members++] = {number, mobile.id};
    }
    if (answer.members != members || answer.areas == 0) continue;
    std::uint32_t nearest = 0;   // of equals the first: areas are numbered by their smallest ids
    for (std::uint32_t number = 1; number < answer.areas; ++number)
      if (distance(number) < distance(nearest)) nearest = number;
    if (answer.members == lists.members.size()) return false;
    lists.members[answer.members++] = {nearest, mobile.id};
  }
  return true;
}

/// Of every area, the held one with most static triangles in common; the first of equals.
void HostAreas::match_held(const Held& held, const ContactLists& lists, const Answer& answer) {
  std::fill_n(most_common_.begin(), answer.areas, 0u);
  for (std::uint32_t h = 0; h < held.areas.size(); ++h) {
    std::fill_n(common_.begin(), answer.areas, 0u);
    for (const std::uint32_t id : held.areas[h].static_ids) {
      const std::uint32_t at = slot(id, lists);
      if (at != kNone) common_[lists.slots[at].area] += 1;
    }
    for (std::uint32_t number = 0; number < answer.areas; ++number) {
      if (common_[number] <= most_common_[number]) continue;
      most_common_[number] = common_[number];
      lists.areas[number].held_area = h;
    }
  }
}

/// The side of sheets, and whether mobile normals are needed.
void HostAreas::begin_area(AreaWork& area, const LatticePose& pose, const Held* held) const {
  if (area.sheets != 0) {
    const std::int32_t kept = area.held_area == kNone ? 0 : held->areas[area.held_area].sheet_sign;
    area.sheet_sign = kept;
    if (kept == 0) {   // +1 when the tool's centre of mass lies on the side to which the sheets face
      const Int3 away = 2 * transform(pose, geometry_->tool_gc) - (area.box_low + area.box_high);
      Wide side = 0;
      for (int k = 0; k < 3; ++k) side += Wide{area.sheet_side[k]} * away[k];
      area.sheet_sign = side >= 0 ? 1 : -1;
    }
    area.flags |= kFlagSheet | (kept != 0 ? kFlagHeld : 0u);
  }
  if (area.cst == 0 && area.samples == 0) {
    area.state |= kAreaProximity;
    area.flags = 0;
  } else if (area.zones > 1 || (!usable(static_sum(area), area.static_weight) && !usable(bare_sum(area), std::int64_t{area.cst} << 30))) {
    area.state |= kAreaWantsMobile;
  }
}

/// Whether a world lattice point lies in a V_bnd or V_int voxel.
bool HostAreas::occupied(const Int3& p) const {
  const GridConstants& grid = constants_.mockup.grid;
  Int3 v;
  for (int k = 0; k < 3; ++k) {
    // Half a step from the nearest integer quotient, which is far more than a double rounds.
    const double along = (static_cast<double>(p[k]) - grid.origin[k] + 0.5) * per_voxel_;
    if (!(along >= 0 && along < 8 * grid.bricks[k])) return false;
    v[k] = static_cast<std::int32_t>(along);
  }
  const std::uint32_t slot = brick_slots_[static_cast<std::size_t>(v.x >> 3) + static_cast<std::size_t>(grid.bricks.x) *
                                          (static_cast<std::size_t>(v.y >> 3) + static_cast<std::size_t>(grid.bricks.y) * static_cast<std::size_t>(v.z >> 3))];
  if (slot >= kBrickInternal) return slot == kBrickInternal;
  const auto bit = static_cast<unsigned>((v.x & 7) | (v.y & 7) << 3 | (v.z & 7) << 6);
  return ((bricks_[slot].boundary[bit >> 5] | bricks_[slot].internal_[bit >> 5]) >> (bit & 31) & 1) != 0;
}

/// Calls take(sample) for each sample of a tool triangle, in the tool's lattice frame. False: too many grid points.
template <class Take>
bool HostAreas::for_tool_samples(std::uint32_t mobile, Take&& take) const {
  const LatticeMesh& tool = geometry_->tool;
  const Int3 a = tool.corner(mobile, 0), b = tool.corner(mobile, 1), c = tool.corner(mobile, 2);
  const int k = tool.sample_axis[mobile], iu = (k + 1) % 3, iv = (k + 2) % 3;
  const std::int64_t spacing = geometry_->sample_spacing;
  const std::int64_t u0 = floor_div(std::min({a[iu], b[iu], c[iu]}), spacing), u1 = floor_div(std::max({a[iu], b[iu], c[iu]}), spacing);
  const std::int64_t v0 = floor_div(std::min({a[iv], b[iv], c[iv]}), spacing), v1 = floor_div(std::max({a[iv], b[iv], c[iv]}), spacing);
  if ((u1 - u0 + 1) > kMostGridPoints || (v1 - v0 + 1) > kMostGridPoints || (u1 - u0 + 1) * (v1 - v0 + 1) > kMostGridPoints) return false;
  const auto normal = [&](int i, int j) {
    return (std::int64_t{b[i]} - a[i]) * (std::int64_t{c[j]} - a[j]) - (std::int64_t{b[j]} - a[j]) * (std::int64_t{c[i]} - a[i]);
  };
  const std::int64_t nk = normal(iu, iv), nu = normal(iv, k), nv = normal(k, iu);
  const int facing = nk < 0 ? -1 : 1;
  // |N_u|, |N_v| ≤ |N_k|, and grid points inside are within the box: products within 2^61.
  const bool small = std::abs(nk) < std::int64_t{1} << 36 && (u1 - u0 + 2) * spacing < 1 << 25 && (v1 - v0 + 2) * spacing < 1 << 25;
  for (std::int64_t v = v0 * spacing; v <= v1 * spacing; v += spacing)
    for (std::int64_t u = u0 * spacing; u <= u1 * spacing; u += spacing) {
      if (exact::grid_side(a[iu], a[iv], b[iu], b[iv], u, v) != facing || exact::grid_side(b[iu], b[iv], c[iu], c[iv], u, v) != facing ||
          exact::grid_side(c[iu], c[iv], a[iu], a[iv], u, v) != facing)
        continue;
      // floor(a_k − (N_u (u − a_u) + N_v (v − a_v)) / N_k)
      Int3 p;
      if (small) {
        p[k] = a[k] + static_cast<std::int32_t>(floor_div(-facing * (nu * (u - a[iu]) + nv * (v - a[iv])), nk * facing));
      } else {
        const Wide over = -facing * (Wide{nu} * (u - a[iu]) + Wide{nv} * (v - a[iv])), under = Wide{nk} * facing, q = over / under;
        p[k] = a[k] + static_cast<std::int32_t>(q - (over % under < 0 ? 1 : 0));
      }
      p[iu] = static_cast<std::int32_t>(u);
      p[iv] = static_cast<std::int32_t>(v);
      take(p);
    }
  return true;
}

/// Lists the tool's samples, which do not depend on the pose, where they are few enough.
void HostAreas::list_tool_samples() {
  const std::size_t triangles = geometry_->tool.triangles.size();
  own_sample_begin_.assign(1, 0);
  for (std::uint32_t id = 0; id < triangles; ++id) {
    const bool few = geometry_->tool.collapsed(id) || for_tool_samples(id, [&](const Int3& p) { own_samples_.push_back(p); });
    if (!few || own_samples_.size() > kMostListed) {
      own_sample_begin_.clear();
      own_samples_ = {};
      return;
    }
    own_sample_begin_.push_back(static_cast<std::uint32_t>(own_samples_.size()));
  }
}

/// Samples of a tool triangle that lie in V_bnd or V_int voxels of the mock-up. False: too many grid points.
bool HostAreas::count_tool_samples(const LatticePose& pose, std::uint32_t mobile, std::uint32_t& count) const {
  count = 0;
  const auto take = [&](const Int3& p) { count += occupied(transform(pose, p)) ? 1u : 0u; };
  if (own_sample_begin_.empty()) return for_tool_samples(mobile, take);
  for (std::uint32_t i = own_sample_begin_[mobile]; i < own_sample_begin_[mobile + 1]; ++i) take(own_samples_[i]);
  return true;
}

bool HostAreas::sum_tool_normals(const LatticePose& pose, const ContactLists& lists, const Answer& answer) const {
  const LatticeMesh& tool = geometry_->tool;
  std::uint32_t mobile = kNone, samples = 0;   // of several areas' triangle entries follow each other
  for (const AreaMember& member : lists.members.first(answer.members)) {
    AreaWork& area = lists.areas[member.area];
    if ((area.state & kAreaWantsMobile) == 0) continue;
    if (member.mobile != mobile && !count_tool_samples(pose, mobile = member.mobile, samples)) return false;
    if (samples == 0) continue;
    const auto w = static_cast<std::int64_t>(tool.sample_weight_q30[mobile]);
    const Int3 n = tool.unit_normal_q30[mobile];
    for (int r = 0; r < 3; ++r) {
      const auto& row = pose.rotation_q30[r];
      const std::int64_t turned = (std::int64_t{row[0]} * n.x + std::int64_t{row[1]} * n.y + std::int64_t{row[2]} * n.z + (std::int64_t{1} << 29)) >> 30;
      area.mobile_sum[r] += std::int64_t{samples} * ((w * turned) >> 30);
    }
    area.mobile_weight += std::int64_t{samples} * w;
  }
  return true;
}

/// n_c by the rules of section 6.
void HostAreas::direct(AreaWork& area, const Held* held) const {
  if ((area.state & kAreaProximity) != 0) return;
  if (constants_.tool.closed == 0 && constants_.tool.has_internal == 0) area.flags |= kFlagToolOpen;
  struct Rule {
    Sum sum;
    std::int64_t weight;
    bool tells;   // a sum of samples that has cancelled is told
  };
  Sum mobile = sum_of(area.mobile_sum);
  for (std::int64_t& component : mobile) component = -component;
  const Rule by_samples{static_sum(area), area.static_weight, true}, bare{bare_sum(area), std::int64_t{area.cst} << 30, false},
      by_tool{mobile, area.mobile_weight, true};
  const std::array<const Rule*, 3> rules = area.zones > 1 ? std::array<const Rule*, 3>{&by_tool, &by_samples, &bare}
                                                          : std::array<const Rule*, 3>{&by_samples, &bare, &by_tool};
  for (const Rule* rule : rules) {
    if (usable(rule->sum, rule->weight)) {
      area.direction = normalise(rule->sum);
      return;
    }
    if (rule->tells && rule->weight > 0) area.flags |= kFlagCancelled;
  }
  if (area.held_area != kNone) {
    area.flags |= kFlagHeld;
    area.direction = held->areas[area.held_area].direction;
    return;
  }
  const Int3 d = way_to_nearest_external(constants_.mockup.grid, brick_slots_, bricks_, (area.box_low + area.box_high) >> 1);
  area.flags |= d == Int3(0) ? kFlagNoDirection : kFlagNearestExternal;
  if (d != Int3(0)) area.direction = normalise({d.x, d.y, d.z});
}

bool HostAreas::solve(PosedTool& tool, const Held* held, const ContactLists& lists, Answer& answer) {
  const LatticePose& pose = tool.pose();
  answer = {};
  if (lists.statics.size() > most_statics_) return false;
  if (!lists.numbered) number(lists);
  const bool gathered = on_this_processor([&] {
    join_all(lists);
    count_samples(lists);
    return gather(lists, answer);
  });
  if (!gathered) return false;
  if (!associate(tool, lists, answer)) return false;
  const std::span<AreaWork> areas = lists.areas.first(answer.areas);
  if (held != nullptr) match_held(*held, lists, answer);
  for (AreaWork& area : areas) begin_area(area, pose, held);
  if (!on_this_processor([&] { return sum_tool_normals(pose, lists, answer); })) return false;
  for (AreaWork& area : areas) direct(area, held);
  return true;
}

}  // namespace palpate

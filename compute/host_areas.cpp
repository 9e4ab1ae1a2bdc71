#include "compute/host_areas.h"

#include <algorithm>
#include <bit>
#include <cstdlib>
#include <cstring>

#include "compute/host_exact.h"
#include "compute/nearest_external.h"

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

}  // namespace

Result<HostAreas> HostAreas::make(VulkanDevice& device, const SceneGeometry& geometry, const PreparedScene& scene, std::size_t most_statics, bool zones) {
  HostAreas out;
  out.zones_ = zones;
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
  out.slot_of_.resize(triangles);
  out.most_statics_ = most_statics;
  out.parents_.resize((zones ? 2 : 1) * std::min(triangles, most_statics));
  out.tool_samples_.resize(geometry.tool.triangles.size(), kNone);
  out.list_tool_samples();
  return out;
}

std::uint32_t HostAreas::root(std::uint32_t node) {
  while (parents_[node] != node) node = parents_[node] = parents_[parents_[node]];
  return node;
}

void HostAreas::join(std::uint32_t a, std::uint32_t b, const ContactLists& lists) {
  a = root(a);
  b = root(b);
  if (a == b) return;
  // The root of a set is its smallest id.
  if (lists.statics[slot_of_node(a)].id > lists.statics[slot_of_node(b)].id) std::swap(a, b);
  parents_[b] = a;
}

/// The slot of a static triangle, kNone if it is not in C_s.
std::uint32_t HostAreas::slot(std::uint32_t id, const ContactLists& lists) const {
  const std::uint32_t at = slot_of_[id];
  return at < lists.statics.size() && lists.statics[at].id == id ? at : kNone;
}

void HostAreas::join_all(const ContactLists& lists) {
  const LatticeMesh& mesh = geometry_->mockup;
  for (std::uint32_t i = 0; i < lists.statics.size(); ++i) {
    slot_of_[lists.statics[i].id] = i;
    parents_[area_node(i)] = area_node(i);
    if (zones_) parents_[zone_node(i)] = zone_node(i);
  }
  const auto count = static_cast<std::uint32_t>(lists.statics.size());
  for (std::uint32_t i = 0; i < count; ++i) {
    const std::uint32_t id = lists.statics[i].id;
    if (i + 2 * kAhead < count) {
      const std::uint32_t later = lists.statics[i + 2 * kAhead].id;
      __builtin_prefetch(&mesh.neighbour_begin[later]);
      __builtin_prefetch(&seam_begin_[later]);
    }
    if (i + kAhead < count) __builtin_prefetch(mesh.neighbours.data() + mesh.neighbour_begin[lists.statics[i + kAhead].id]);
    // Ascending: beyond its own number the others join from their side.
    for (std::uint32_t e = mesh.neighbour_begin[id]; e < mesh.neighbour_begin[id + 1] && mesh.neighbours[e] >> 1 < id; ++e) {
      const std::uint32_t to = slot(mesh.neighbours[e] >> 1, lists);
      if (to == kNone) continue;
      join(area_node(i), area_node(to), lists);
      if (zones_ && (mesh.neighbours[e] & 1) != 0) join(zone_node(i), zone_node(to), lists);
    }
    // Seams are smooth by definition.
    for (std::uint32_t e = seam_begin_[id]; e < seam_begin_[id + 1] && seams_[e] < id; ++e) {
      const std::uint32_t to = slot(seams_[e], lists);
      if (to == kNone) continue;
      join(area_node(i), area_node(to), lists);
      if (zones_) join(zone_node(i), zone_node(to), lists);
    }
  }
}

/// Every slot adds its triangle to its area.
void HostAreas::gather(const ContactLists& lists) {
  const LatticeMesh& mesh = geometry_->mockup;
  const auto count = static_cast<std::uint32_t>(lists.statics.size());
  for (std::uint32_t i = 0; i < count; ++i) {
    if (i + 2 * kAhead < count) {
      const std::uint32_t later = lists.statics[i + 2 * kAhead].id;
      __builtin_prefetch(&mesh.triangles[later]);
      __builtin_prefetch(&mesh.unit_normal_q30[later]);
      __builtin_prefetch(&mesh.sample_weight_q30[later]);
      __builtin_prefetch(&mesh.flags[later]);
    }
    if (i + kAhead < count)
      for (const std::uint32_t vertex : mesh.triangles[lists.statics[i + kAhead].id]) __builtin_prefetch(&mesh.vertices[vertex]);
    StaticResult& result = lists.statics[i];
    const std::uint32_t first = slot_of_node(root(area_node(i))), id = result.id, number = lists.slots[first].area, samples = lists.slots[i].samples;
    result.area = number;
    result.zone = zones_ ? slot_of_node(root(zone_node(i))) : first;
    lists.slots[i].area = number;
    AreaWork& area = lists.areas[number];
    for (int k = 0; k < 3; ++k) {
      const Int3 corner = mesh.corner(id, k);
      area.box_low = glm::min(area.box_low, corner);
      area.box_high = glm::max(area.box_high, corner);
    }
    area.statics += 1;
    if (result.zone == i) area.zones += 1;
    const bool hit = (result.state & kStaticHit) != 0, sheet = (mesh.flags[id] & kTriangleSheet) != 0;
    if (hit) area.cst += 1;
    if (sheet) area.sheets += 1;
    // A term (w·n̂) >> 30 is within 2^31, a triangle's samples within 2^32: the sums stay within 2^63 for 2^32 samples in all.
    const auto w = static_cast<std::int64_t>(mesh.sample_weight_q30[id]);
    for (std::size_t k = 0; k < 3; ++k) {
      const std::int64_t n = mesh.unit_normal_q30[id][static_cast<int>(k)];
      (sheet ? area.sheet_sum : area.fixed_sum)[k] += std::int64_t{samples} * ((w * n) >> 30);
      if (hit) (sheet ? area.bare_sheet : area.bare_fixed)[k] += n;
      if (sheet) area.sheet_side[k] += n;
    }
    area.samples += samples;
    area.static_weight += std::int64_t{samples} * w;
  }
}

/// Gives every tool triangle of C_m to the areas whose spheres hold its rounded centroid, else to the nearest.
bool HostAreas::associate(PosedTool& tool, const ContactLists& lists, Answer& answer) {
  for (const MobileResult& mobile : lists.mobiles) {
    const exact::Corners& t = tool.corners(mobile.id);
    const Int3 sum = t[0] + t[1] + t[2];
    const Int3 g(floor_div(sum.x, 3), floor_div(sum.y, 3), floor_div(sum.z, 3));
    bool held = false;
    std::uint32_t nearest = kNone;
    std::int64_t least = 0;
    for (std::uint32_t number = 0; number < answer.areas; ++number) {
      const AreaWork& area = lists.areas[number];
      const std::int64_t distance = squared(2 * g - (area.box_low + area.box_high));   // components within 2^30
      if (distance <= squared(area.box_high - area.box_low)) {
        if (answer.members == lists.members.size()) return false;
        lists.members[answer.members++] = {number, mobile.id};
        held = true;
      }
      if (nearest == kNone || distance < least || (distance == least && area.id < lists.areas[nearest].id)) {
        nearest = number;
        least = distance;
      }
    }
    if (held || nearest == kNone) continue;
    if (answer.members == lists.members.size()) return false;
    lists.members[answer.members++] = {nearest, mobile.id};
  }
  return true;
}

/// The held area with most static triangles in common; the first of equals.
std::uint32_t HostAreas::match_held(std::uint32_t area, const Held& held, const ContactLists& lists) const {
  std::uint32_t best = kNone, most = 0;
  for (std::uint32_t h = 0; h < held.areas.size(); ++h) {
    std::uint32_t common = 0;
    for (const std::uint32_t id : held.areas[h].static_ids) {
      const std::uint32_t at = slot(id, lists);
      common += at != kNone && lists.slots[at].area == area ? 1u : 0u;
    }
    if (common <= most) continue;
    most = common;
    best = h;
  }
  return best;
}

/// The side of sheets, and whether mobile normals are needed.
void HostAreas::begin_area(AreaWork& area, std::uint32_t number, const LatticePose& pose, const Held* held, const ContactLists& lists) const {
  if (held != nullptr) area.held_area = match_held(number, *held, lists);
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

bool HostAreas::sum_tool_normals(const LatticePose& pose, const ContactLists& lists, const Answer& answer) {
  const LatticeMesh& tool = geometry_->tool;
  const std::span<const AreaMember> members = lists.members.first(answer.members);
  for (const AreaMember& member : members) tool_samples_[member.mobile] = kNone;
  for (const AreaMember& member : members) {
    AreaWork& area = lists.areas[member.area];
    if ((area.state & kAreaWantsMobile) == 0) continue;
    std::uint32_t& samples = tool_samples_[member.mobile];
    if (samples == kNone && !count_tool_samples(pose, member.mobile, samples)) return false;
    const auto w = static_cast<std::int64_t>(tool.sample_weight_q30[member.mobile]);
    const Int3 n = tool.unit_normal_q30[member.mobile];
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
  join_all(lists);
  for (std::uint32_t i = 0; i < lists.statics.size(); ++i) {
    lists.slots[i] = {kNone, 0};
    if (parents_[area_node(i)] != area_node(i)) continue;
    if (answer.areas == kMaxFrameAreas) return false;
    lists.slots[i].area = answer.areas;
    AreaWork& area = lists.areas[answer.areas++];
    std::memset(static_cast<void*>(&area), 0, sizeof area);
    area.box_low = Int3(INT32_MAX);
    area.box_high = Int3(-INT32_MAX);
    area.id = lists.statics[i].id;
    area.held_area = kNone;
  }
  for (const FrameSample& sample : lists.samples) lists.slots[slot(sample.static_id, lists)].samples += 1;
  gather(lists);
  if (!associate(tool, lists, answer)) return false;
  const std::span<AreaWork> areas = lists.areas.first(answer.areas);
  for (std::uint32_t number = 0; number < answer.areas; ++number) begin_area(areas[number], number, pose, held, lists);
  if (!sum_tool_normals(pose, lists, answer)) return false;
  for (AreaWork& area : areas) direct(area, held);
  return true;
}

}  // namespace palpate

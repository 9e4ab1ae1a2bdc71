#include "model/contact/contact_areas.h"

#include <algorithm>
#include <bit>
#include <cstdint>
#include <cstdlib>
#include <numeric>
#include <vector>

namespace palpate {
namespace {

std::int64_t floor_third(std::int64_t sum) { return sum >= 0 ? sum / 3 : -((2 - sum) / 3); }

/// Triangles joined into sets, each known by its first member.
class Sets {
 public:
  explicit Sets(std::size_t count) : parent_(count) {
    std::iota(parent_.begin(), parent_.end(), std::uint32_t{0});
  }
  std::uint32_t first(std::uint32_t i) {
    while (parent_[i] != i) i = parent_[i] = parent_[parent_[i]];
    return i;
  }
  void join(std::uint32_t a, std::uint32_t b) {
    a = first(a);
    b = first(b);
    if (a < b)
      parent_[b] = a;
    else
      parent_[a] = b;
  }

 private:
  std::vector<std::uint32_t> parent_;
};

/// Which of the carriers a triangle is.
class Places {
 public:
  static constexpr std::uint32_t kNone = UINT32_MAX;
  explicit Places(const std::vector<CarrierSums>& carriers)
      : entries_(std::bit_ceil(2 * carriers.size() + 1), Entry{kNone, kNone}) {
    for (std::uint32_t i = 0; i < carriers.size(); ++i) entries_[entry(carriers[i].id)] = {carriers[i].id, i};
  }
  /// kNone: it is none.
  std::uint32_t of(std::uint32_t id) const { return entries_[entry(id)].place; }

 private:
  struct Entry {
    std::uint32_t id, place;
  };
  /// Where the id is, or would be. At most half of the entries are taken.
  std::size_t entry(std::uint32_t id) const {
    std::size_t at = id * std::size_t{0x9E3779B97F4A7C15} >> 32;
    while (entries_[at &= entries_.size() - 1].id != id && entries_[at].id != kNone) ++at;
    return at;
  }
  std::vector<Entry> entries_;
};

/// Where an area lies.
struct Bounds {
  Int3 low{INT32_MAX}, high{INT32_MIN};
  void include(const Int3& p) {
    low = glm::min(low, p);
    high = glm::max(high, p);
  }
};

/// C_m to areas by the chapter's rule (EXACTNESS section 5): every area whose sphere holds the triangle's
/// centroid, else the nearest.
void associate(const SceneGeometry& geometry, const LatticePose& pose, const std::vector<Bounds>& bounds,
               Contacts& contacts) {
  if (contacts.areas.empty()) return;
  std::vector<std::uint32_t> mobile;  // ascending, as each of the sets does
  mobile.reserve(contacts.cmt.size() + contacts.bmt.size() + contacts.imt.size());
  for (const auto* set : {&contacts.cmt, &contacts.bmt, &contacts.imt}) {
    const auto before = static_cast<std::ptrdiff_t>(mobile.size());
    mobile.insert(mobile.end(), set->begin(), set->end());
    std::inplace_merge(mobile.begin(), mobile.begin() + before, mobile.end());
  }
  struct Sphere {
    Long3 twice_middle;
    std::int64_t squared_diameter;
  };
  std::vector<Sphere> spheres;
  for (const Bounds& box : bounds) {
    const Long3 diagonal = Long3(box.high) - Long3(box.low);
    spheres.push_back({Long3(box.low) + Long3(box.high), diagonal.x * diagonal.x + diagonal.y * diagonal.y +
                                                             diagonal.z * diagonal.z});  // within 3 · 2^60
  }
  for (const std::uint32_t m : mobile) {
    Long3 sum(0);
    for (int k = 0; k < 3; ++k) sum += Long3(transform(pose, geometry.tool.corner(m, k)));
    const Long3 g(floor_third(sum.x), floor_third(sum.y), floor_third(sum.z));
    std::size_t nearest = 0;
    std::int64_t nearest_distance = -1;
    bool held = false;
    for (std::size_t a = 0; a < spheres.size(); ++a) {
      const Long3 away = std::int64_t{2} * g - spheres[a].twice_middle;
      const std::int64_t distance = away.x * away.x + away.y * away.y + away.z * away.z;  // likewise
      if (distance <= spheres[a].squared_diameter) {
        contacts.areas[a].mobile_ids.push_back(m);
        held = true;
      }
      if (nearest_distance < 0 || distance < nearest_distance) nearest_distance = distance, nearest = a;
    }
    if (!held) contacts.areas[nearest].mobile_ids.push_back(m);
  }
}

}  // namespace

Int3 lattice_direction(const Long3& sum) {
  const std::int64_t largest = std::max({std::llabs(sum.x), std::llabs(sum.y), std::llabs(sum.z)});
  int left = 0, right = 0;
  while (largest << left < std::int64_t{1} << 28) ++left;
  while (largest >> right >= std::int64_t{1} << 29) ++right;
  Int3 out;
  for (int k = 0; k < 3; ++k) {
    const std::int64_t size = std::llabs(sum[k]) << left >> right;  // one of them is 0
    out[k] = static_cast<std::int32_t>(sum[k] < 0 ? -size : size);
  }
  return out;
}

void gather_areas(const SceneGeometry& geometry, const LatticePose& pose, Contacts& contacts) {
  contacts.areas.clear();
  const std::vector<CarrierSums>& carriers = contacts.carriers;
  const LatticeMesh& mesh = geometry.mockup;
  Sets areas(carriers.size()), zones(carriers.size());
  const Places places(carriers);
  for (std::uint32_t i = 0; i < carriers.size(); ++i)
    for (std::uint32_t n = mesh.neighbour_begin[carriers[i].id]; n < mesh.neighbour_begin[carriers[i].id + 1];
         ++n) {
      const std::uint32_t j = places.of(mesh.neighbours[n] >> 1);
      if (j == Places::kNone) continue;
      areas.join(i, j);
      if ((mesh.neighbours[n] & 1u) != 0) zones.join(i, j);
    }

  // Carriers ascend, so the first of a set names it and sets come in the order of their names.
  std::vector<std::size_t> area_at(carriers.size()), zone_at(carriers.size());
  std::vector<Bounds> bounds;
  for (std::uint32_t i = 0; i < carriers.size(); ++i) {
    const CarrierSums& carrier = carriers[i];
    const std::uint32_t first = areas.first(i), zone = zones.first(i);
    if (first == i) {
      area_at[i] = contacts.areas.size();
      contacts.areas.emplace_back().id = carrier.id;
      bounds.emplace_back();
    }
    ContactArea& area = contacts.areas[area_at[first]];
    if (zone == i) {
      zone_at[i] = area.zones.size();
      area.zones.emplace_back();
    }
    area.static_ids.push_back(carrier.id);
    area.zones[zone_at[zone]].push_back(carrier.id);
    if ((mesh.flags[carrier.id] & kTriangleSheet) != 0) area.flags |= kFlagSheet;
    area.field += carrier;
    for (int k = 0; k < 3; ++k) bounds[area_at[first]].include(mesh.corner(carrier.id, k));
  }
  for (ContactArea& area : contacts.areas) {
    // A push that may not fit 64 bits loses its low 32, all of its components alike: terms within 2^62 >> 32,
    // fewer than 2^31 of them.
    const auto large = [](const WideSum& push) {
      return std::llabs(push.high + (push.low >> 32)) >= std::int64_t{1} << 29;
    };
    const bool wide = std::any_of(area.field.push.begin(), area.field.push.end(), large);
    Long3 sum(0);
    for (int k = 0; k < 3; ++k) {
      const WideSum& push = area.field.push[static_cast<std::size_t>(k)];
      const std::int64_t high = push.high + (push.low >> 32);
      sum[k] = wide ? high : high * (std::int64_t{1} << 32) + (push.low & 0xFFFFFFFF);
    }
    if (sum != Long3(0)) area.direction = lattice_direction(sum);
    area.rays = area.field.samples;
  }
  associate(geometry, pose, bounds, contacts);
}

}  // namespace palpate

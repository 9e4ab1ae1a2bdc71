#include "cpu_ref/areas.h"

#include <algorithm>

namespace palpate::cpu_ref {
namespace {

/// Who of C_s is joined to whom. Triangles are named by their place in C_s.
struct Links {
  struct Link {
    std::uint32_t to;
    bool smooth;
  };
  std::vector<std::vector<Link>> of;
};

/// The place of a triangle in C_s, or C_s.size().
std::size_t place(const std::vector<std::uint32_t>& contact_static, std::uint32_t id) {
  const auto found = std::lower_bound(contact_static.begin(), contact_static.end(), id);
  return found != contact_static.end() && *found == id
             ? static_cast<std::size_t>(found - contact_static.begin())
             : contact_static.size();
}

Links shared_edges(const Frame& frame) {
  const LatticeMesh& mesh = frame.mockup();
  Links links;
  links.of.resize(frame.contact_static.size());
  for (std::size_t i = 0; i < frame.contact_static.size(); ++i) {
    const std::uint32_t s = frame.contact_static[i];
    for (std::uint32_t n = mesh.neighbour_begin[s]; n < mesh.neighbour_begin[s + 1]; ++n) {
      const std::size_t j = place(frame.contact_static, mesh.neighbours[n] >> 1);
      if (j < links.of.size())
        links.of[i].push_back({static_cast<std::uint32_t>(j), (mesh.neighbours[n] & 1) != 0});
    }
  }
  return links;
}

/// Component number of every triangle: numbered in the order of their smallest member.
std::vector<std::uint32_t> components(const Links& links, bool smooth_only) {
  constexpr std::uint32_t kNone = UINT32_MAX;
  std::vector<std::uint32_t> component(links.of.size(), kNone);
  std::uint32_t count = 0;
  std::vector<std::uint32_t> open;
  for (std::uint32_t start = 0; start < component.size(); ++start) {
    if (component[start] != kNone) continue;
    component[start] = count;
    open.push_back(start);
    while (!open.empty()) {
      const std::uint32_t i = open.back();
      open.pop_back();
      for (const Links::Link& link : links.of[i])
        if ((link.smooth || !smooth_only) && component[link.to] == kNone) {
          component[link.to] = count;
          open.push_back(link.to);
        }
    }
    ++count;
  }
  return component;
}

/// |2g − c2|² with g the rounded centroid. 2g and c2 within 2^29: the square within 3 · 2^60.
std::int64_t doubled_distance2(const Int3& doubled_centre, const Int3& g) {
  const Long3 away = Long3(g) * std::int64_t{2} - Long3(doubled_centre);
  return away.x * away.x + away.y * away.y + away.z * away.z;
}

void assign_mobile(const Frame& frame, std::vector<Area>& areas) {
  for (const std::uint32_t m : frame.contact_mobile) {
    const Long3 sum = Long3(frame.tool[m][0]) + Long3(frame.tool[m][1]) + Long3(frame.tool[m][2]);
    Int3 g;
    for (int k = 0; k < 3; ++k) g[k] = static_cast<std::int32_t>(floor_divide(sum[k], std::int64_t{3}));
    Area* nearest = nullptr;
    std::int64_t nearest_distance2 = 0;
    bool held = false;
    for (Area& area : areas) {
      const std::int64_t distance2 = doubled_distance2(area.doubled_centre(), g);
      const Long3 diagonal = difference(area.box.max, area.box.min);
      if (distance2 <= diagonal.x * diagonal.x + diagonal.y * diagonal.y + diagonal.z * diagonal.z) {
        area.out.mobile_ids.push_back(m);
        held = true;
      }
      if (nearest == nullptr || distance2 < nearest_distance2) {
        nearest = &area;
        nearest_distance2 = distance2;
      }
    }
    if (!held && nearest != nullptr) nearest->out.mobile_ids.push_back(m);
  }
}

}  // namespace

std::vector<Area> find_areas(const Frame& frame) {
  const Links links = shared_edges(frame);
  const std::vector<std::uint32_t> area_of = components(links, false), zone_of = components(links, true);

  std::vector<Area> areas;
  std::vector<std::uint32_t> zone_place(links.of.size());  // of each zone: its place in its area
  std::vector<bool> zone_seen(links.of.size(), false);
  for (std::size_t i = 0; i < area_of.size(); ++i) {
    const std::uint32_t s = frame.contact_static[i];
    if (area_of[i] == areas.size()) {  // C_s is ascending: the first triangle of a component names it
      areas.emplace_back();
      areas.back().out.id = s;
    }
    Area& area = areas[area_of[i]];
    area.out.static_ids.push_back(s);
    for (int k = 0; k < 3; ++k) area.box.include(frame.mockup().corner(s, k));
    const std::uint32_t zone = zone_of[i];
    if (!zone_seen[zone]) {
      zone_seen[zone] = true;
      zone_place[zone] = static_cast<std::uint32_t>(area.out.zones.size());
      area.out.zones.emplace_back();
    }
    area.out.zones[zone_place[zone]].push_back(s);
  }
  assign_mobile(frame, areas);
  return areas;
}

}  // namespace palpate::cpu_ref

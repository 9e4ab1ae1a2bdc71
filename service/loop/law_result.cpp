#include "service/loop/law_result.h"

#include <algorithm>
#include <cmath>
#include <cstddef>

#include "model/contact/contacts.h"

namespace palpate {
namespace {

double extrapolation_stiffness(const AreaResponse& area, double stiffness) {
  return stiffness * std::clamp(area.slope, 0.25, 1.0);
}

ContactPlane plane_of(const AreaResponse& area, const Vec3& gc, double stiffness) {
  return {.normal = area.normal,
          .lever = glm::cross(area.point - gc, area.normal),
          .force = glm::dot(area.force, area.normal),
          .stiffness = extrapolation_stiffness(area, stiffness)};
}

}  // namespace

void fill_planes(const ContactResponse& response, PlaneSet& out) {
  out.plane_count = 0;
  for (const ContactPlane& plane : response.planes) add_plane(out, plane);
}

void fill_law_result(const ContactResponse& response, bool field, double stiffness, LawResult& out) {
  out.wrench = response.wrench;
  out.contact = response.contact;
  out.plane_count = 0;
  out.field = field;
  if (field) {
    fill_planes(response, out);
    for (std::uint32_t i = 0; i < out.plane_count; ++i) out.planes[i].stiffness *= kFirmer;
    out.areas = static_cast<std::uint32_t>(response.areas.size());
    return;
  }

  // Areas that push, by their position; a swallowed tool adds one to kMaxAreas.
  std::array<const AreaResponse*, kMaxAreas + 1> pushing{};
  std::uint32_t count = 0;
  for (const AreaResponse& area : response.areas)
    if (count < pushing.size() && glm::dot(area.force, area.normal) > 0) pushing[count++] = &area;
  out.areas = count;

  // The largest keep a plane each. Equal forces stay in the order of their ids, so the choice is the same
  // every time.
  const std::uint32_t own = count <= kMaxLawPlanes ? count : kMaxLawPlanes - 1;
  if (own < count)
    std::sort(pushing.begin(), pushing.begin() + count, [](const AreaResponse* a, const AreaResponse* b) {
      const double force_a = glm::dot(a->force, a->normal), force_b = glm::dot(b->force, b->normal);
      return force_a != force_b ? force_a > force_b : a->id < b->id;
    });
  for (std::uint32_t i = 0; i < own; ++i)
    out.planes[out.plane_count++] = plane_of(*pushing[i], response.gc, stiffness);
  if (own == count) return;

  // The rest act as one.
  Vec3 force(0), torque(0);
  for (std::uint32_t i = own; i < count; ++i) {
    force += pushing[i]->force;
    torque += glm::cross(pushing[i]->point - response.gc, pushing[i]->force);
  }
  const double size = std::sqrt(glm::dot(force, force));
  if (!(size > 1e-9)) return;  // N; a newton's billionth is nothing
  ContactPlane rest{.normal = force / size, .lever = torque / size, .force = size, .stiffness = 0};
  for (std::uint32_t i = own; i < count; ++i) {
    const double along = glm::dot(rest.normal, pushing[i]->normal);
    rest.stiffness += extrapolation_stiffness(*pushing[i], stiffness) * along * along;
  }
  out.planes[out.plane_count++] = rest;
}

}  // namespace palpate

#include "model/contact/response.h"

#include <algorithm>
#include <cmath>
#include <cstdint>

#include "model/contact/field_response.h"
#include "model/lattice/wide_sum.h"

namespace palpate {
namespace {

constexpr double kQ24 = 16777216.0;  // 2^24

Vec3 to_metres(const Lattice& lattice, const Vec3& steps) {
  return lattice.origin_m + lattice.step_m * steps;
}

Vec3 unit(const Int3& direction) {
  const Vec3 d(direction);
  const double length = std::sqrt(d.x * d.x + d.y * d.y + d.z * d.z);
  return length > 0 ? d / length : Vec3(0);
}

/// ∂d/∂h of `paper`, whose sums say nothing about it: estimated from ρ = d/h as ρ + 3 (ρ − ½)₊ (1 − ρ), exact
/// for a flat contact (1) and a corner (⅓) and at most 1.3 % above for a cap up to half its radius deep.
double paper_slope(double mean, double largest) {
  const double ratio = largest > 0 ? mean / largest : 1.0;
  return ratio + 3 * std::max(0.0, ratio - 0.5) * (1 - ratio);
}

/// The letter: K d n_c at the mean of the area's voxels.
void respond_by_chapter(const ContactArea& area, const Lattice& lattice, double stiffness, bool points,
                        const Vec3& gc, AreaResponse& out) {
  const Vec3 direction(area.direction);
  const double length =
      std::sqrt(direction.x * direction.x + direction.y * direction.y + direction.z * direction.z);
  if (area.rays == 0 || !(length > 0)) return;
  const double metres_per_height = length * lattice.step_m / kQ30,
               mean = static_cast<double>(area.height_sum) / area.rays;
  out.depth = metres_per_height * mean;
  out.max_depth = metres_per_height * static_cast<double>(area.max_height);
  out.slope = paper_slope(mean, static_cast<double>(area.max_height));
  if (points && area.voxel_count > 0)
    out.point = to_metres(lattice, Vec3(area.voxel_sum[0], area.voxel_sum[1], area.voxel_sum[2]) /
                                       static_cast<double>(area.voxel_count));
  out.force = stiffness * out.depth * out.normal;  // eq. 3
  out.torque = glm::cross(out.point - gc, out.force);
}

/// What the area's own samples say of the field.
void respond_by_field(const CarrierSums& sums, const LatticePose& pose, const SceneGeometry& geometry,
                      double stiffness, bool points, const Vec3& gc, AreaResponse& out) {
  if (sums.samples == 0 || sums.weight_sum == 0) return;
  const double step = geometry.lattice.step_m, side = step * geometry.sample_spacing;
  const double pressed = static_cast<double>(sums.depth_sum) / 1024;  // Σ φ w, steps
  out.depth = step * pressed * kQ24 / static_cast<double>(sums.weight_sum);
  out.max_depth = step * sums.max_depth;
  const Vec3 push(to_double(sums.push[0]), to_double(sums.push[1]), to_double(sums.push[2]));
  out.force = (field_modulus(geometry, stiffness) * step * side * side / kQ30) * push;
  if (points && pressed > 0) {
    const Vec3 moment(to_double(sums.moment[0]), to_double(sums.moment[1]), to_double(sums.moment[2]));
    out.point = to_metres(geometry.lattice, Vec3(pose.translation) + moment / pressed);
    out.torque = glm::cross(out.point - gc, out.force);
  }
}

}  // namespace

void respond(const Contacts& contacts, const LatticePose& pose, const SceneGeometry& geometry,
             Profile profile, double stiffness, ContactResponse& out) {
  const Lattice& lattice = geometry.lattice;
  // gc follows the lattice pose, not the pose asked for: the wrench belongs to what was judged.
  Vec3 gc_steps(0);
  const Vec3 gc_tool = (geometry.tool_gc_m - geometry.tool_centre_m) / lattice.step_m;
  for (int r = 0; r < 3; ++r)
    gc_steps[r] = (pose.rotation_q30[r][0] * gc_tool.x + pose.rotation_q30[r][1] * gc_tool.y +
                   pose.rotation_q30[r][2] * gc_tool.z) /
                      kQ30 +
                  pose.translation[r];
  out.gc = to_metres(lattice, gc_steps);
  out.wrench = {};
  out.max_depth = 0;
  out.felt.reset();
  out.flags = contacts.flags;
  out.contact = contacts.contact;
  out.contact_points = contacts.contact_points;
  out.areas.clear();
  out.planes.clear();
  if (contacts.truncated || !contacts.contact) return;

  for (const ContactArea& area : contacts.areas) {
    AreaResponse& response = out.areas.emplace_back();
    response.id = area.id;
    response.flags = area.flags;
    response.normal = unit(area.direction);
    response.point = out.gc;
    if (profile == Profile::kPaper)
      respond_by_chapter(area, lattice, stiffness, contacts.contact_points, out.gc, response);
    else
      respond_by_field(area.field, pose, geometry, stiffness, contacts.contact_points, out.gc, response);
    out.flags |= area.flags;
    if (profile != Profile::kPaper) continue;
    out.wrench.force += response.force;
    out.wrench.torque += response.torque;
  }
  if (profile == Profile::kPaper) return;
  out.max_depth = lattice.step_m * contacts.field.max_depth;
  out.wrench = field_wrench(contacts.field, pose, geometry, stiffness, out.gc);
  field_planes(contacts.field, pose, geometry, stiffness, out.gc, out.planes);
  if (!contacts.contact_points) out.wrench.torque = Vec3(0);
}

}  // namespace palpate

#include "service/loop/plane_set.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "driver/limits.h"
#include "model/lattice/rotation.h"

namespace palpate {
namespace {

/// How far the tool has come since a set's pose.
struct Motion {
  Vec3 moved, turned;
  Motion(const PlaneSet& set, const Vec3& gc, const Quat& rotation)
      : moved(gc - set.gc),
        turned(rotation_vector(rotation * glm::conjugate(set.rotation))) {}  // the short way
};

double force_at(const ContactPlane& plane, const Motion& motion, bool grows) {
  const double out =
      glm::dot(plane.normal, motion.moved) + glm::dot(plane.lever, motion.turned);  // n_cᵀ J ΔX
  const double force = std::max(0.0, plane.force - plane.stiffness * out);
  return grows ? force : std::min(force, plane.force);
}

/// How unlike two planes are: a tenth of a radian of direction counts as much as a centimetre of lever.
double unlikeness(const ContactPlane& a, const ContactPlane& b) {
  const Vec3 turn = a.normal - b.normal, lever = (a.lever - b.lever) / 0.1;
  return glm::dot(turn, turn) + glm::dot(lever, lever);
}
constexpr double kAlike = 1e-4;  ///< a hundredth of a radian, or a millimetre of lever (chosen)

ContactPlane merged(const ContactPlane& a, const ContactPlane& b) {
  const Vec3 force = a.force * a.normal + b.force * b.normal;
  const double size = length(force);
  if (!(size > 1e-9 * (a.force + b.force)))
    return a.force >= b.force ? a : b;  // they cancel: a couple at most is lost
  ContactPlane sum{.normal = force / size,
                   .lever = (a.force * a.lever + b.force * b.lever) / size,
                   .force = size,
                   .stiffness = 0};
  for (const ContactPlane* one : {&a, &b}) {
    const double along = glm::dot(sum.normal, one->normal);
    sum.stiffness += one->stiffness * along * along;
  }
  return sum;
}

/// The plane of a set most like another, and how unlike it is.
std::uint32_t most_alike(const PlaneSet& set, const ContactPlane& plane, double& least) {
  std::uint32_t nearest = 0;
  least = std::numeric_limits<double>::infinity();
  for (std::uint32_t i = 0; i < set.plane_count; ++i) {
    const double turn = set.planes[i].normal.x - plane.normal.x;
    if (turn * turn >= least) continue;  // a part of it is too much already
    if (const double unlike = unlikeness(set.planes[i], plane); unlike < least) least = unlike, nearest = i;
  }
  return nearest;
}

void add(PlaneSet& into, const ContactPlane& plane) {
  double least = 0;
  const std::uint32_t nearest = most_alike(into, plane, least);
  if (into.plane_count > 0 && (least < kAlike || into.plane_count == kMaxLawPlanes)) {
    into.planes[nearest] = merged(into.planes[nearest], plane);
  } else {
    into.planes[into.plane_count++] = plane;
  }
}

}  // namespace

void add_plane(PlaneSet& into, const ContactPlane& plane) {
  if (into.plane_count < kMaxLawPlanes) {
    into.planes[into.plane_count++] = plane;
    return;
  }
  double least = 0;
  const std::uint32_t nearest = most_alike(into, plane, least);
  into.planes[nearest] = merged(into.planes[nearest], plane);
}

Wrench pushed(const PlaneSet& set, const Vec3& gc, const Quat& rotation, bool grows) {
  Wrench sum;
  if (set.plane_count == 0) return sum;
  const Motion motion(set, gc, rotation);
  for (std::uint32_t i = 0; i < set.plane_count; ++i) {
    const double force = force_at(set.planes[i], motion, grows);
    sum.force += force * set.planes[i].normal;
    sum.torque += force * set.planes[i].lever;
  }
  return sum;
}

void add_pushed(Wrench& push, StiffnessMatrix& slope, const PlaneSet& set, double share, const Vec3& gc,
                const Quat& rotation, bool grows) {
  if (set.plane_count == 0 || !(share > 0)) return;
  const Motion motion(set, gc, rotation);
  Wrench sum;
  for (std::uint32_t i = 0; i < set.plane_count; ++i) {
    const ContactPlane& plane = set.planes[i];
    const double force = force_at(plane, motion, grows);
    if (!(force > 0)) continue;
    sum.force += force * plane.normal;
    sum.torque += force * plane.lever;
    if (!grows && force >= plane.force) continue;  // held at its bound, it doesn't give way
    const std::array<double, 6> along{plane.normal.x, plane.normal.y, plane.normal.z,
                                      plane.lever.x,  plane.lever.y,  plane.lever.z};
    for (std::size_t row = 0; row < 6; ++row) {
      const double gives = share * plane.stiffness * along[row];
      for (std::size_t column = 0; column <= row; ++column) slope[row][column] += gives * along[column];
    }
  }
  push.force += share * sum.force;
  push.torque += share * sum.torque;
}

void add_pushes(PlaneSet& into, const PlaneSet& set, double share, bool grows) {
  if (set.plane_count == 0 || !(share > 0)) return;
  const Motion motion(set, into.gc, into.rotation);
  for (std::uint32_t i = 0; i < set.plane_count; ++i) {
    ContactPlane plane = set.planes[i];
    plane.force = share * force_at(plane, motion, grows);
    plane.stiffness *= share;
    if (plane.force > 0) add(into, plane);
  }
}

bool sound(const PlaneSet& set) {
  if (set.plane_count > kMaxLawPlanes || !sound(Pose{set.gc, set.rotation})) return false;
  for (std::uint32_t i = 0; i < set.plane_count; ++i) {
    const ContactPlane& plane = set.planes[i];
    if (!finite(plane.normal) || !finite(plane.lever) || !std::isfinite(plane.force) ||
        !(plane.stiffness >= 0 && std::isfinite(plane.stiffness)))
      return false;
  }
  return true;
}

}  // namespace palpate

#include "bench/haptic/on_plane.h"

#include <algorithm>

#include "bench/haptic/solids.h"

namespace yardstick {

TriMesh ground() { return box(Vec3(-0.06, -0.06, -0.02), Vec3(0.06, 0.06, 0)); }

std::vector<Pose> over_the_edge(const TriMesh& tool, const Pose& deep, double lift, std::size_t count) {
  const double edge = 0.06, beside = 0.001;
  double low = 1, high = -1;  // what is in the ground, or would be at twice the depth and as far above
  double lowest = 1;
  for (const Vec3& v : tool.vertices) lowest = std::min(lowest, (deep.rotation * v + deep.position).z);
  for (const Vec3& v : tool.vertices) {
    const Vec3 place = deep.rotation * v;
    if (place.z + deep.position.z > -lowest) continue;
    low = std::min(low, place.x);
    high = std::max(high, place.x);
  }
  const Vec3 up(0, 0, lift);
  const auto at = [&](double x) { return Pose{Vec3(x, deep.position.y, deep.position.z), deep.rotation}; };
  // A contact lets go in its last tenths of a millimetre: a fifth of the poses goes there.
  const Pose on = at(edge - high - beside), last = at(edge - low - beside), off = at(edge - low + beside);
  return along({on, last, off, moved(off, up, Vec3(0)), moved(on, up, Vec3(0)), on}, count);
}

namespace {

/// A rigid face lets go of an edge at once, and no sum over poses sees that work: bodies that stand on a face
/// are moved and turned on the plane instead.
std::vector<Pose> on_its_face(const Pose& deep, double lift, std::size_t count) {
  const Vec3 aside(0.003, 0, 0), yaw(0, 0, 0.2), up(0, 0, lift);
  return along({deep, moved(deep, aside, yaw), moved(deep, aside + up, yaw), moved(deep, up, Vec3(0)), deep},
               count);
}

}  // namespace

Case on_plane(const std::string& name, const std::string& group, TriMesh tool, double depth,
              const Amount& amount) {
  Case out;
  out.name = name;
  out.group = group;
  out.truth_from = "rigid tool in a plane: K d along its normal, no torque, by symmetry";
  out.fixed = ground();
  out.tool = std::move(tool);
  finish(out);
  double lowest = 0;
  for (const Vec3& v : out.tool.vertices) lowest = std::min(lowest, v.z);
  const auto place = [&](double d) { return Pose{Vec3(0, 0, -lowest - d)}; };
  out.path = along({place(-depth / 10), place(depth)}, amount.path);
  for (const Pose& pose : out.path) {
    const double push = out.stiffness * std::max(0.0, -lowest - pose.position.z);
    out.truths.push_back({Vec3(0, 0, push), Vec3(0), {}, push});
  }
  out.rest = place(depth / 2);
  const auto lowest_ones = std::count_if(out.tool.vertices.begin(), out.tool.vertices.end(),
                                         [&](const Vec3& v) { return v.z < lowest + 1e-9; });
  out.loop = lowest_ones > 1 ? on_its_face(out.rest, 5 * depth, amount.loop)
                             : over_the_edge(out.tool, out.rest, 5 * depth, amount.loop);
  return out;
}

}  // namespace yardstick

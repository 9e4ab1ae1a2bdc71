#include "model/mesh/weld.h"

#include <fmt/format.h>
#include <cmath>
#include <limits>

#include "model/lattice/triangle.h"

namespace palpate {
namespace {

constexpr std::uint32_t kNone = std::numeric_limits<std::uint32_t>::max();

/// Finds equal lattice points: open addressing over the vertex list itself, so it costs 4 bytes a slot.
class PointIndex {
 public:
  explicit PointIndex(std::vector<Int3>& points) : points_(points), slots_(1024, kNone) {}

  /// The number of `point`, appended to the list if it is new.
  std::uint32_t number(const Int3& point) {
    if ((points_.size() + 1) * 2 > slots_.size()) grow();
    std::size_t slot = home(point);
    while (slots_[slot] != kNone) {
      if (points_[slots_[slot]] == point) return slots_[slot];
      slot = (slot + 1) & (slots_.size() - 1);
    }
    slots_[slot] = static_cast<std::uint32_t>(points_.size());
    points_.push_back(point);
    return slots_[slot];
  }

 private:
  std::size_t home(const Int3& p) const {
    // Multiply and fold, per component: neighbouring points of a regular grid must not collide.
    std::uint64_t h = 0;
    for (int k = 0; k < 3; ++k) {
      h = (h ^ static_cast<std::uint32_t>(p[k])) * 0x9E3779B97F4A7C15u;
      h ^= h >> 32;
    }
    return static_cast<std::size_t>(h) & (slots_.size() - 1);
  }

  void grow() {
    slots_.assign(slots_.size() * 2, kNone);
    for (std::uint32_t i = 0; i < points_.size(); ++i) {
      std::size_t slot = home(points_[i]);
      while (slots_[slot] != kNone) slot = (slot + 1) & (slots_.size() - 1);
      slots_[slot] = i;
    }
  }

  std::vector<Int3>& points_;
  std::vector<std::uint32_t> slots_;  ///< a power of two of them, at most half full
};

/// Of a mesh far from its origin: that single precision, in which most files are read, leaves nothing of it.
std::string where_digits_end(const Mesh& mesh) {
  double farthest = 0;
  for (const Vec3& v : mesh.vertices)
    farthest = std::fmax(farthest, std::fmax(std::fabs(v.x), std::fmax(std::fabs(v.y), std::fabs(v.z))));
  constexpr double kMillimetreSteps = 1e4;  // m: from there on, of single precision
  if (farthest < kMillimetreSteps) return {};
  return fmt::format("; they lie {:.3g} m from their origin, where single precision has steps of {:.2g} m",
                     farthest, std::ldexp(farthest, -23));
}

}  // namespace

Result<LatticeMesh> snap_and_weld(const Mesh& mesh, const Lattice& lattice) {
  if (mesh.triangles.size() > kMaxTriangles)
    return bad_value(
        fmt::format("the mesh has {} triangles, the limit is {}", mesh.triangles.size(), kMaxTriangles));
  LatticeMesh out;
  out.triangles.resize(mesh.triangles.size());
  out.flags.assign(mesh.triangles.size(), 0);
  std::vector<std::uint32_t> welded(mesh.vertices.size(), kNone);  // mesh vertex → lattice vertex
  PointIndex index(out.vertices);
  bool any = false;
  for (std::size_t t = 0; t < mesh.triangles.size(); ++t) {
    for (std::size_t k = 0; k < 3; ++k) {
      const std::uint32_t v = mesh.triangles[t][k];
      if (v >= mesh.vertices.size())
        return bad_value(fmt::format("triangle {}: vertex index {} is beyond the vertex list (size {})", t, v,
                                     mesh.vertices.size()));
      if (welded[v] == kNone) {
        const Vec3 steps = (mesh.vertices[v] - lattice.origin_m) / lattice.step_m;
        Int3 point;
        for (int axis = 0; axis < 3; ++axis) {
          if (!(std::abs(steps[axis]) <= kLatticeReach))  // false for a NaN too
            return bad_value(fmt::format(
                "vertex {}: coordinate {} m is not within the lattice ({} m either side of {} m)", v,
                mesh.vertices[v][axis], lattice.step_m * kLatticeReach, lattice.origin_m[axis]));
          point[axis] = static_cast<std::int32_t>(std::nearbyint(steps[axis]));
        }
        welded[v] = index.number(point);
      }
      out.triangles[t][k] = welded[v];
    }
    const std::uint32_t id = static_cast<std::uint32_t>(t);
    if (raw_normal(out, id) == Long3(0)) {
      out.flags[t] = kTriangleCollapsed;
      continue;
    }
    for (int k = 0; k < 3; ++k) {
      const Int3& corner = out.corner(id, k);
      out.box_min = any ? glm::min(out.box_min, corner) : corner;
      out.box_max = any ? glm::max(out.box_max, corner) : corner;
      any = true;
    }
  }
  if (!any)
    return bad_value(mesh.triangles.empty()
                         ? std::string("the mesh has no triangles")
                         : fmt::format("all {} triangles collapse on the lattice (step {} m){}",
                                       mesh.triangles.size(), lattice.step_m, where_digits_end(mesh)));
  return out;
}

}  // namespace palpate

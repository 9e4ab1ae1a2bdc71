#include <algorithm>
#include <array>
#include <cmath>

#include "model/lattice/triangle.h"
#include "model/mesh/orientation.h"

namespace palpate {
namespace {

__extension__ typedef __int128 Int128;

int sign(std::int64_t value) { return (value > 0) - (value < 0); }
int sign(Int128 value) { return (value > 0) - (value < 0); }

/// A line along `axis` through a triangle's centroid. All coordinates are tripled, so that the centroid is a
/// whole point strictly inside its triangle: |coordinate| ≤ 3 · 2^28 < 2^30.
struct Line {
  std::uint32_t triangle = 0;
  std::uint32_t answer = 0;  ///< place in the result
  Long3 centroid{0};         ///< a + b + c
  Long3 normal{0};
};

/// The lines along one axis, sorted into the cells of a square grid over the plane across it. Triangles are
/// then streamed past the lines, so memory follows the lines, however large or many the triangles are.
class LineGrid {
 public:
  LineGrid(std::vector<Line> lines, int axis)
      : u_((axis + 1) % 3), v_((axis + 2) % 3), lines_(std::move(lines)) {
    side_ = std::clamp<std::int64_t>(static_cast<std::int64_t>(std::sqrt(static_cast<double>(lines_.size()))),
                                     1, 1024);
    low_ = high_ = lines_.front().centroid;
    for (const Line& line : lines_) {
      low_ = glm::min(low_, line.centroid);
      high_ = glm::max(high_, line.centroid);
    }
    std::stable_sort(lines_.begin(), lines_.end(),
                     [&](const Line& a, const Line& b) { return cell(a) < cell(b); });
    begin_.assign(static_cast<std::size_t>(side_ * side_) + 1, 0);
    for (const Line& line : lines_) ++begin_[static_cast<std::size_t>(cell(line)) + 1];
    for (std::size_t c = 1; c < begin_.size(); ++c) begin_[c] += begin_[c - 1];
  }

  /// Calls visit(line) for all lines whose projection lies in the box, and perhaps some more.
  template <class Visit>
  void for_each_in(const Long3& box_min, const Long3& box_max, Visit visit) const {
    if (box_max[u_] < low_[u_] || box_min[u_] > high_[u_] || box_max[v_] < low_[v_] ||
        box_min[v_] > high_[v_])
      return;
    const std::int64_t first = column(box_min[u_]), last = column(box_max[u_]);
    for (std::int64_t row = row_of(box_min[v_]); row <= row_of(box_max[v_]); ++row) {
      const std::size_t end = begin_[static_cast<std::size_t>(row * side_ + last) + 1];
      for (std::size_t i = begin_[static_cast<std::size_t>(row * side_ + first)]; i < end; ++i)
        visit(lines_[i]);
    }
  }

 private:
  std::int64_t place(std::int64_t x, std::int64_t low, std::int64_t high) const {
    return (std::clamp(x, low, high) - low) * side_ / (high - low + 1);  // below 2^31 · 2^10
  }
  std::int64_t column(std::int64_t u) const { return place(u, low_[u_], high_[u_]); }
  std::int64_t row_of(std::int64_t v) const { return place(v, low_[v_], high_[v_]); }
  std::int64_t cell(const Line& line) const {
    return row_of(line.centroid[v_]) * side_ + column(line.centroid[u_]);
  }

  int u_, v_;
  std::int64_t side_ = 1;
  Long3 low_{0}, high_{0};
  std::vector<Line> lines_;
  std::vector<std::size_t> begin_;
};

/// Whether the perturbed point g + (ε, ε²), in (u, v), lies inside the projected triangle (tripled corners).
/// Differences are below 2^31, products below 2^62.
bool inside(const std::array<Long3, 3>& corners, const Long3& g, int u, int v, int normal_sign) {
  for (std::size_t k = 0; k < 3; ++k) {
    const Long3 &p = corners[k], &q = corners[(k + 1) % 3];
    const std::int64_t du = q[u] - p[u], dv = q[v] - p[v];
    int side = sign(du * (g[v] - p[v]) - dv * (g[u] - p[u]));
    if (side == 0) side = dv != 0 ? -sign(dv) : sign(du);
    if (side != normal_sign) return false;
  }
  return true;
}

/// Whether the plane of a triangle (normal n, tripled corner a) passes above (+1) or below (−1) the line's
/// centroid along `axis`; 0 if it is the plane of the line's own triangle. Where they meet in the centroid
/// itself, the perturbed centroid, moved by (ε, ε²) within its own triangle, decides.
int plane_side(const Line& line, const Long3& n, const Long3& a, int axis, int u, int v) {
  const int upwards = sign(n[axis]);
  Int128 height = 0;  // N·(centroid − a): below 3 · 2^59.2 · 2^31 < 2^92
  for (int k = 0; k < 3; ++k) height += Int128{n[k]} * (line.centroid[k] - a[k]);
  if (height != 0) return -sign(height) * upwards;
  const int own_upwards = sign(line.normal[axis]);
  for (const int along : {u, v}) {
    // Along u the own triangle climbs by −n'_u / n'_axis, so N·step = N_u − N_axis n'_u / n'_axis: below
    // 2^119.4.
    const Int128 climb = Int128{n[along]} * line.normal[axis] - Int128{n[axis]} * line.normal[along];
    if (climb != 0) return -sign(climb) * own_upwards * upwards;
  }
  return 0;
}

}  // namespace

std::vector<SideWinding> side_windings(const LatticeMesh& mesh, const std::vector<std::uint32_t>& triangles) {
  std::vector<SideWinding> windings(triangles.size());
  std::array<std::vector<Line>, 3> lines;
  for (std::uint32_t i = 0; i < triangles.size(); ++i) {
    const std::uint32_t t = triangles[i];
    const Long3 normal = raw_normal(mesh, t);
    const Long3 centroid = Long3(mesh.corner(t, 0)) + Long3(mesh.corner(t, 1)) + Long3(mesh.corner(t, 2));
    lines[static_cast<std::size_t>(dominant_axis(normal))].push_back({t, i, centroid, normal});
  }
  for (int axis = 0; axis < 3; ++axis) {
    if (lines[static_cast<std::size_t>(axis)].empty()) continue;
    const int u = (axis + 1) % 3, v = (axis + 2) % 3;
    const LineGrid grid(std::move(lines[static_cast<std::size_t>(axis)]), axis);
    for (std::uint32_t t = 0; t < mesh.triangles.size(); ++t) {
      if (mesh.collapsed(t)) continue;
      const std::array<Long3, 3> corners = {Long3(mesh.corner(t, 0)) * std::int64_t{3},
                                            Long3(mesh.corner(t, 1)) * std::int64_t{3},
                                            Long3(mesh.corner(t, 2)) * std::int64_t{3}};
      const Long3 box_min = glm::min(glm::min(corners[0], corners[1]), corners[2]);
      const Long3 box_max = glm::max(glm::max(corners[0], corners[1]), corners[2]);
      Long3 normal(0);
      grid.for_each_in(box_min, box_max, [&](const Line& line) {
        if (line.triangle == t) return;
        if (normal == Long3(0)) normal = raw_normal(mesh, t);
        const int upwards = sign(normal[axis]);
        if (upwards == 0 || !inside(corners, line.centroid, u, v, upwards)) return;
        const int side = plane_side(line, normal, corners[0], axis, u, v);
        if (side == 0) return;
        // Away from the centroid, upwards or downwards: +1 where the ray leaves through an outward face.
        const int crossing = side * upwards;
        SideWinding& winding = windings[line.answer];
        (side == sign(line.normal[axis]) ? winding.normal_side : winding.back_side) += crossing;
      });
    }
  }
  return windings;
}

}  // namespace palpate

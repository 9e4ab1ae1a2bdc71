#include "model/mesh/boundary.h"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <tuple>
#include <unordered_map>

namespace palpate {
namespace {

std::array<std::int64_t, 6> line_of(const Int3& d, const Long3& m) { return {d.x, d.y, d.z, m.x, m.y, m.z}; }

/// Edges that share a vertex are one loop; the largest diagonal of a loop's box.
double largest_loop(const LatticeMesh& mesh, const std::vector<std::array<std::uint32_t, 2>>& edges) {
  std::unordered_map<std::uint32_t, std::uint32_t> parent;
  const auto root = [&](std::uint32_t v) {
    parent.try_emplace(v, v);
    while (parent[v] != v) v = parent[v] = parent[parent[v]];
    return v;
  };
  for (const auto& [low, high] : edges) parent[root(low)] = root(high);
  struct LoopBox {
    Int3 min, max;
  };
  std::unordered_map<std::uint32_t, LoopBox> boxes;
  for (const auto& edge : edges)
    for (const std::uint32_t v : edge) {
      const Int3& point = mesh.vertices[v];
      LoopBox& box = boxes.try_emplace(root(v), LoopBox{point, point}).first->second;
      box = {glm::min(box.min, point), glm::max(box.max, point)};
    }
  double largest = 0;
  for (const auto& [loop, box] : boxes) {
    const Vec3 size = Vec3(box.max) - Vec3(box.min);
    largest = std::max(largest, std::sqrt(size.x * size.x + size.y * size.y + size.z * size.z));
  }
  return largest;
}

}  // namespace

void Boundary::add(const LatticeMesh& mesh, std::uint32_t low, std::uint32_t high, int incidence) {
  const Int3 &p = mesh.vertices[low], &q = mesh.vertices[high];
  Int3 d = q - p;
  const int divisor = std::gcd(std::gcd(d.x, d.y), d.z);  // > 0: welded vertices differ
  d /= divisor;
  const int axis = d.x != 0 ? 0 : d.y != 0 ? 1 : 2;
  if (d[axis] < 0) d = -d;
  const Long3 point(p), along(d);
  const Long3 moment(point.y * along.z - point.z * along.y, point.z * along.x - point.x * along.z,
                     point.x * along.y - point.y * along.x);
  ends_.push_back({d, moment, p[axis], incidence, {low, high}});
  ends_.push_back({d, moment, q[axis], -incidence, {low, high}});
}

bool Boundary::cancels(const LatticeMesh& mesh) {
  std::sort(ends_.begin(), ends_.end(), [](const End& a, const End& b) {
    return std::tuple(line_of(a.direction, a.moment), a.place) <
           std::tuple(line_of(b.direction, b.moment), b.place);
  });
  std::vector<std::array<std::uint32_t, 2>> open;
  for (std::size_t first = 0; first < ends_.size();) {
    // A line's edges cancel when their number does not change anywhere along it.
    std::size_t i = first;
    bool balanced = true;
    const auto line = line_of(ends_[first].direction, ends_[first].moment);
    while (i < ends_.size() && line_of(ends_[i].direction, ends_[i].moment) == line) {
      const std::int32_t place = ends_[i].place;
      std::int64_t change = 0;
      for (; i < ends_.size() && ends_[i].place == place &&
             line_of(ends_[i].direction, ends_[i].moment) == line;
           ++i)
        change += ends_[i].change;
      balanced &= change == 0;
    }
    for (; first < i; ++first)
      if (!balanced) open.push_back(ends_[first].edge);
  }
  largest_gap_ = largest_loop(mesh, open);
  return open.empty();
}

}  // namespace palpate

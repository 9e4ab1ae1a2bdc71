#include "compute/native/queries/distance_lattice.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <glm/geometric.hpp>
#include <limits>

#include "compute/native/queries/pair_distance.h"
#include "compute/scene/shares.h"
#include "model/lattice/lattice.h"

namespace palpate::native {
namespace {

/// Square of a point's distance to a triangle: to its face where the point is above that, else to an edge.
double squared_distance(const Vec3& p, const Vec3 (&t)[3]) {
  const Vec3 n = glm::cross(t[1] - t[0], t[2] - t[0]);
  bool above = glm::dot(n, n) > 0;
  double least = std::numeric_limits<double>::infinity();
  for (std::size_t e = 0; e < 3; ++e) {
    const Vec3 edge = t[(e + 1) % 3] - t[e], from = p - t[e];
    above = above && glm::dot(glm::cross(n, edge), from) >= 0;
    const double size = glm::dot(edge, edge),
                 at = size > 0 ? std::clamp(glm::dot(edge, from) / size, 0.0, 1.0) : 0;
    const Vec3 off = from - at * edge;
    least = std::min(least, glm::dot(off, off));
  }
  if (!above) return least;
  const double height = glm::dot(n, p - t[0]);
  return std::min(least, height * height / glm::dot(n, n));
}

struct Node {
  std::uint32_t level, index;
  double squared;
};

/// Square of a point's distance to the triangles of a tree, if it is below `most`, else that.
double nearest(const LatticeMesh& mesh, const TriangleTree& tree, const Vec3& p, double most,
               std::vector<Node>& open) {
  const BoxOf point{{p.x, p.y, p.z}, {p.x, p.y, p.z}};
  std::array<double, kLanes> gaps;
  std::array<std::uint32_t, kLanes> order;
  open.clear();
  open.push_back({static_cast<std::uint32_t>(tree.level_begin.size()), 0, 0});
  while (!open.empty()) {
    const Node node = open.back();
    open.pop_back();
    if (node.squared >= most) continue;
    if (node.level == 0) {
      for (std::size_t i = kLanes * node.index; i < std::min(kLanes * (node.index + 1), tree.order.size());
           ++i) {
        const std::uint32_t id = tree.order[i];
        most = std::min(most, squared_distance(p, {Vec3(mesh.corner(id, 0)), Vec3(mesh.corner(id, 1)),
                                                   Vec3(mesh.corner(id, 2))}));
      }
      continue;
    }
    box_gaps(point, tree.boxes[tree.level_begin[node.level - 1] + node.index], gaps);
    const std::uint32_t first = static_cast<std::uint32_t>(kLanes) * node.index,
                        children =
                            std::min(static_cast<std::uint32_t>(kLanes), tree.nodes(node.level - 1) - first);
    std::uint32_t count = 0;
    for (std::uint32_t i = 0; i < children; ++i) {  // the nearest last
      if (gaps[i] >= most) continue;
      std::uint32_t at = count++;
      for (; at > 0 && gaps[order[at - 1]] < gaps[i]; --at) order[at] = order[at - 1];
      order[at] = i;
    }
    for (std::uint32_t n = 0; n < count; ++n)
      open.push_back({node.level - 1, first + order[n], gaps[order[n]]});
  }
  return most;
}

}  // namespace

DistanceLattice::DistanceLattice(const LatticeMesh& mesh, const TriangleTree& tree, double margin) {
  double side[3], longest = 1;
  for (int k = 0; k < 3; ++k)
    longest = std::max(longest, static_cast<double>(mesh.box_max[k]) - mesh.box_min[k]);
  margin = std::clamp(margin, 1.0, longest);
  for (int k = 0; k < 3; ++k) {
    low_[k] = mesh.box_min[k] - margin;
    side[k] = static_cast<double>(mesh.box_max[k]) - mesh.box_min[k] + 2 * margin;
  }
  const auto nodes = [&] {
    double product = 1;
    for (int k = 0; k < 3; ++k) {
      count_[k] = static_cast<std::uint32_t>(side[k] / spacing_) + 2;
      product *= count_[k];
    }
    return product;
  };
  spacing_ = std::cbrt(side[0] * side[1] * side[2] / kMostNodes);
  while (nodes() > kMostNodes) spacing_ *= 1.05;  // ends: with the longest side they are 27 at most
  per_spacing_ = 1 / spacing_;
  squared_.resize(std::size_t{count_[0]} * count_[1] * count_[2]);
  if (tree.order.empty()) return;  // no surface: zeros promise nothing
  const auto fill = [&](std::uint32_t row) {
    const std::uint32_t y = row % count_[1], z = row / count_[1];
    std::vector<Node> open;
    double before = std::numeric_limits<double>::infinity();
    for (std::uint32_t x = 0; x < count_[0]; ++x) {
      const Vec3 p(low_[0] + x * spacing_, low_[1] + y * spacing_, low_[2] + z * spacing_);
      const double most = (before + spacing_) * (before + spacing_) * (1 + 0x1p-30) + 1,
                   found = nearest(mesh, tree, p, most, open);
      before = std::sqrt(found);
      // Doubles are off by less than a step and 2^-30; a float is by 2^-24.
      const double sure = std::max(before * (1 - 0x1p-22) - 1, 0.0);
      squared_[x + std::size_t{count_[0]} * row] = static_cast<float>(sure * sure);
    }
  };
  in_shares(count_[1] * count_[2], fill, [](std::uint32_t) { return true; });
}

double DistanceLattice::squared(const std::array<double, 3>& point) const {
  double away = 0, spread = 0, part[3];
  std::size_t node[3];
  for (std::size_t k = 0; k < 3; ++k) {
    const double at = (point[k] - low_[k]) * per_spacing_,
                 within = std::clamp(at, 0.0, static_cast<double>(count_[k] - 1));
    away += (at - within) * (at - within);
    node[k] = std::min(static_cast<std::size_t>(within), std::size_t{count_[k] - 2});
    part[k] = within - static_cast<double>(node[k]);
    spread += part[k] * (1 - part[k]);
  }
  const std::size_t row = count_[0], plane = row * count_[1];
  const float* const c = &squared_[node[0] + row * node[1] + plane * node[2]];
  const auto along = [&](const float* at) { return at[0] + part[0] * (static_cast<double>(at[1]) - at[0]); };
  const auto across = [&](const float* at) {
    const double first = along(at);
    return first + part[1] * (along(at + row) - first);
  };
  const double first = across(c), mean = first + part[2] * (across(c + plane) - first);
  return away * spacing_ * spacing_ + std::max(mean - spread * spacing_ * spacing_, 0.0);
}

}  // namespace palpate::native

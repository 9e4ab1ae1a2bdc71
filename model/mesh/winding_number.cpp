#include "model/mesh/winding_number.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <glm/common.hpp>
#include <glm/geometric.hpp>
#include <limits>
#include <numbers>
#include <utility>

namespace palpate {
namespace {

constexpr double kFar = 2.5;            // of a cluster's radius: from there on it is a dipole (chosen)
constexpr std::uint32_t kCells = 1024;  // along an axis

/// Ten bits with two zeros after each.
std::uint32_t spread(std::uint32_t bits) {
  std::uint32_t out = 0;
  for (unsigned i = 0; i < 10; ++i) out |= (bits >> i & 1U) << (3 * i);
  return out;
}

/// Solid angle of a triangle seen from the origin (van Oosterom, Strackee 1983).
double solid_angle(const std::array<Vec3, 3>& t) {
  const double a = glm::length(t[0]), b = glm::length(t[1]), c = glm::length(t[2]);
  return 2 * std::atan2(
                 glm::dot(t[0], glm::cross(t[1], t[2])),
                 a * b * c + glm::dot(t[0], t[1]) * c + glm::dot(t[1], t[2]) * a + glm::dot(t[2], t[0]) * b);
}

}  // namespace

WindingNumber::WindingNumber(const LatticeMesh& mesh) : mesh_(&mesh) {
  const Vec3 low(mesh.box_min);
  const double cell = std::max({1.0, static_cast<double>(mesh.box_max.x) - mesh.box_min.x,
                                static_cast<double>(mesh.box_max.y) - mesh.box_min.y,
                                static_cast<double>(mesh.box_max.z) - mesh.box_min.z}) /
                      (kCells - 1);
  const auto corner = [&](std::uint32_t id, int k) { return Vec3(mesh.corner(id, k)); };
  std::vector<std::uint64_t> keys;
  for (std::uint32_t id = 0; id < mesh.triangles.size(); ++id) {
    if (mesh.collapsed(id) || (mesh.flags[id] & kTriangleSheet) != 0) continue;
    const Vec3 at = ((corner(id, 0) + corner(id, 1) + corner(id, 2)) / 3.0 - low) / cell;
    std::uint64_t key = 0;
    for (int k = 0; k < 3; ++k) key |= spread(static_cast<std::uint32_t>(at[k])) << k;
    keys.push_back(key << 32 | id);
  }
  std::sort(keys.begin(), keys.end());
  order_.reserve(keys.size());
  for (const std::uint64_t key : keys) order_.push_back(static_cast<std::uint32_t>(key));

  // Of the one below what is here, or of triangles.
  const auto gather = [](std::size_t count, const auto& add_to) {
    std::vector<Cluster> out;
    for (std::size_t first = 0; first < count; first += kWide) {
      Cluster& cluster = out.emplace_back();
      cluster.low = Int3(std::numeric_limits<std::int32_t>::max());
      cluster.high = Int3(std::numeric_limits<std::int32_t>::min());
      for (std::size_t i = first; i < std::min(first + kWide, count); ++i) add_to(i, cluster);
      cluster.centre /= cluster.size;
      const Vec3 furthest = glm::max(Vec3(cluster.high) - cluster.centre, cluster.centre - Vec3(cluster.low));
      cluster.radius = glm::length(furthest);
    }
    return out;
  };
  const auto join = [](Cluster& cluster, const Vec3& centre, const Vec3& area, double size, const Int3& least,
                       const Int3& most) {
    cluster.centre += size * centre;
    cluster.area += area;
    cluster.size += size;
    cluster.low = glm::min(cluster.low, least);
    cluster.high = glm::max(cluster.high, most);
  };
  levels_.push_back(gather(order_.size(), [&](std::size_t i, Cluster& cluster) {
    const Int3 a = mesh.corner(order_[i], 0), b = mesh.corner(order_[i], 1), c = mesh.corner(order_[i], 2);
    const Vec3 area = glm::cross(Vec3(b) - Vec3(a), Vec3(c) - Vec3(a)) / 2.0;
    join(cluster, (Vec3(a) + Vec3(b) + Vec3(c)) / 3.0, area, glm::length(area), glm::min(a, glm::min(b, c)),
         glm::max(a, glm::max(b, c)));
  }));
  while (levels_.back().size() > 1) {
    const std::vector<Cluster>& below = levels_.back();
    levels_.push_back(gather(below.size(), [&](std::size_t i, Cluster& cluster) {
      join(cluster, below[i].centre, below[i].area, below[i].size, below[i].low, below[i].high);
    }));
  }
}

double WindingNumber::at(const Vec3& point) const {
  if (order_.empty()) return 0;
  double sum = 0;
  std::vector<std::pair<std::size_t, std::size_t>> open{{levels_.size() - 1, 0}};  // level and place
  while (!open.empty()) {
    const auto [level, place] = open.back();
    open.pop_back();
    const Cluster& cluster = levels_[level][place];
    const Vec3 way = cluster.centre - point;
    if (const double far = glm::length(way); far > kFar * cluster.radius) {
      sum += glm::dot(cluster.area, way) / (far * far * far);
      continue;
    }
    const std::size_t first = kWide * place;
    if (level > 0) {
      for (std::size_t i = first; i < std::min(first + kWide, levels_[level - 1].size()); ++i)
        open.emplace_back(level - 1, i);
      continue;
    }
    for (std::size_t i = first; i < std::min(first + kWide, order_.size()); ++i) {
      std::array<Vec3, 3> corners;
      for (std::size_t k = 0; k < 3; ++k)
        corners[k] = Vec3(mesh_->corner(order_[i], static_cast<int>(k))) - point;
      sum += solid_angle(corners);
    }
  }
  return sum / (4 * std::numbers::pi);
}

}  // namespace palpate

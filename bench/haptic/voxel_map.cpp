#include "bench/haptic/voxel_map.h"

#include <algorithm>
#include <array>
#include <cmath>

namespace yardstick {
namespace {

constexpr std::uint8_t kFree = 0, kSurface = 1, kUnknown = 255;

/// Whether a triangle meets a cube about 0 of half edge h: separating axes (the cube's, the triangle's plane,
/// edges across edges).
bool meets(const std::array<Vec3, 3>& corner, double h) {
  const auto apart = [&](const Vec3& axis) {
    const double a = glm::dot(axis, corner[0]), b = glm::dot(axis, corner[1]), c = glm::dot(axis, corner[2]);
    const double half = h * (std::abs(axis.x) + std::abs(axis.y) + std::abs(axis.z));
    return std::min({a, b, c}) > half || std::max({a, b, c}) < -half;
  };
  const std::array<Vec3, 3> edge{corner[1] - corner[0], corner[2] - corner[1], corner[0] - corner[2]};
  const std::array<Vec3, 3> unit{Vec3(1, 0, 0), Vec3(0, 1, 0), Vec3(0, 0, 1)};
  if (apart(glm::cross(edge[0], edge[1]))) return false;
  for (const Vec3& u : unit)
    if (apart(u)) return false;
  for (const Vec3& u : unit)
    for (const Vec3& e : edge)
      if (apart(glm::cross(u, e))) return false;
  return true;
}

}  // namespace

void VoxelMap::build(const TriMesh& mesh, int across) {
  Vec3 low = mesh.vertices.front(), high = low;
  for (const Vec3& v : mesh.vertices) {
    low = glm::min(low, v);
    high = glm::max(high, v);
  }
  const Vec3 extent = high - low;
  size_ = std::max({extent.x, extent.y, extent.z}) / across;
  inverse_ = 1 / size_;
  origin_ = low - 1.5 * size_;  // a border of free voxels, where the flood begins
  for (int k = 0; k < 3; ++k) count_[k] = static_cast<int>(std::ceil(extent[k] / size_)) + 3;
  cells_.assign(index(0, 0, count_[2]), kUnknown);
  mark(mesh);
  flood();
  layer();
}

void VoxelMap::mark(const TriMesh& mesh) {
  for (const auto& t : mesh.triangles) {
    const std::array<Vec3, 3> corner{mesh.vertices[t[0]] - origin_, mesh.vertices[t[1]] - origin_,
                                     mesh.vertices[t[2]] - origin_};
    const Vec3 low = glm::floor(glm::min(corner[0], glm::min(corner[1], corner[2])) / size_),
               high = glm::floor(glm::max(corner[0], glm::max(corner[1], corner[2])) / size_);
    for (int z = static_cast<int>(low.z); z <= static_cast<int>(high.z); ++z)
      for (int y = static_cast<int>(low.y); y <= static_cast<int>(high.y); ++y)
        for (int x = static_cast<int>(low.x); x <= static_cast<int>(high.x); ++x) {
          if (cells_[index(x, y, z)] == kSurface) continue;
          const Vec3 centre = (Vec3(x, y, z) + 0.5) * size_;
          if (meets({corner[0] - centre, corner[1] - centre, corner[2] - centre}, size_ / 2))
            cells_[index(x, y, z)] = kSurface;
        }
  }
}

void VoxelMap::flood() {
  std::vector<std::array<int, 3>> open{{0, 0, 0}};
  cells_[0] = kFree;
  while (!open.empty()) {
    const auto [x, y, z] = open.back();
    open.pop_back();
    for (const auto& [i, j, k] : std::array<std::array<int, 3>, 6>{
             {{-1, 0, 0}, {1, 0, 0}, {0, -1, 0}, {0, 1, 0}, {0, 0, -1}, {0, 0, 1}}}) {
      if (!has(x + i, y + j, z + k) || cells_[index(x + i, y + j, z + k)] != kUnknown) continue;
      cells_[index(x + i, y + j, z + k)] = kFree;
      open.push_back({x + i, y + j, z + k});
    }
  }
}

void VoxelMap::layer() {
  // The 13 neighbours that come before a voxel; those after it are their mirror images. What is inside has
  // all of them, for the map's border is free.
  std::vector<std::ptrdiff_t> before;
  for (int k = -1; k <= 0; ++k)
    for (int j = -1; j <= 1; ++j)
      for (int i = -1; i <= 1; ++i) {
        const std::ptrdiff_t step = (static_cast<std::ptrdiff_t>(k) * count_[1] + j) * count_[0] + i;
        if (step < 0) before.push_back(step);
      }
  const auto sweep = [&](std::ptrdiff_t at, int sign) {
    std::uint8_t& cell = cells_[static_cast<std::size_t>(at)];
    if (cell <= kSurface) return;
    for (const std::ptrdiff_t step : before) {
      const std::uint8_t other = std::max(cells_[static_cast<std::size_t>(at + sign * step)], kSurface);
      if (other < cell) cell = std::min<std::uint8_t>(cell, static_cast<std::uint8_t>(other + 1));
    }
  };
  const auto count = static_cast<std::ptrdiff_t>(cells_.size());
  for (std::ptrdiff_t at = 0; at < count; ++at) sweep(at, 1);
  for (std::ptrdiff_t at = count; at-- > 0;) sweep(at, -1);
}

std::uint8_t VoxelMap::at(const Vec3& point, Vec3& centre) const {
  const Vec3 place = (point - origin_) * inverse_;
  for (int k = 0; k < 3; ++k)
    if (!(place[k] >= 0 && place[k] < count_[k])) return kFree;
  const int x = static_cast<int>(place.x), y = static_cast<int>(place.y), z = static_cast<int>(place.z);
  const std::uint8_t value = cells_[index(x, y, z)];
  if (value != kFree) centre = origin_ + (Vec3(x, y, z) + 0.5) * size_;
  return value;
}

}  // namespace yardstick

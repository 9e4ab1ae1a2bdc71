#include "compute/native/queries/tool_spheres.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace palpate::native {
namespace {

/// About the middle of the box of some triangles' corners.
void set(EightSpheres& spheres, std::size_t i, const LatticeMesh& tool, std::span<const std::uint32_t> ids) {
  Vec3 low(std::numeric_limits<double>::infinity()), high = -low;
  for (const std::uint32_t id : ids)
    for (int k = 0; k < 3; ++k) {
      const Vec3 p(tool.corner(id, k));
      low = glm::min(low, p);
      high = glm::max(high, p);
    }
  Vec3 centre;  // as it is rounded
  for (std::size_t k = 0; k < 3; ++k) {
    const int axis = static_cast<int>(k);
    centre[axis] = spheres.centre[k][i] = static_cast<float>(0.5 * (low[axis] + high[axis]));
  }
  double radius = 0;
  for (const std::uint32_t id : ids)
    for (int k = 0; k < 3; ++k) radius = std::max(radius, glm::length(Vec3(tool.corner(id, k)) - centre));
  spheres.radius[i] =
      std::nextafter(static_cast<float>(radius + 0.5), std::numeric_limits<float>::infinity());
}

}  // namespace

ToolSpheres::ToolSpheres(const LatticeMesh& tool, const TriangleTree& tree) {
  const std::span<const std::uint32_t> order(tree.order);
  for (std::size_t each = 1; !order.empty(); each *= kLanes) {  // triangles a sphere
    std::vector<EightSpheres>& level =
        levels_.emplace_back((order.size() + kLanes * each - 1) / (kLanes * each));
    for (EightSpheres& group : level) {
      for (auto& axis : group.centre) axis.fill(kNoSphere);
      group.radius.fill(0);
    }
    for (std::size_t first = 0; first < order.size(); first += each) {
      const std::size_t number = first / each;
      set(level[number / kLanes], number % kLanes, tool,
          order.subspan(first, std::min(each, order.size() - first)));
    }
    if (level.size() == 1) break;
  }
}

std::uint64_t ToolSpheres::bytes() const {
  std::uint64_t sum = 0;
  for (const auto& level : levels_) sum += sizeof level[0] * std::uint64_t{level.size()};
  return sum;
}

}  // namespace palpate::native

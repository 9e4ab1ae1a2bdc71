#include "compute/native/broad_phase/run_tree.h"

#include <algorithm>
#include <cmath>
#include <glm/common.hpp>

namespace palpate {

RunTree::RunTree(const LatticeMesh& tool, std::span<const std::uint32_t> order) : order_(order) {
  std::vector<Int3> low((order.size() + kEight - 1) / kEight, Int3(INT32_MAX)),
      high(low.size(), Int3(INT32_MIN));
  for (std::size_t place = 0; place < order.size(); ++place) {
    if (tool.collapsed(order[place])) continue;
    for (int corner = 0; corner < 3; ++corner) {
      const Int3 p = tool.corner(order[place], corner);
      low[place / kEight] = glm::min(low[place / kEight], p);
      high[place / kEight] = glm::max(high[place / kEight], p);
    }
  }
  while (true) {
    std::vector<EightBoxes>& level = levels_.emplace_back((low.size() + kEight - 1) / kEight);
    std::vector<Int3> low_above(level.size(), Int3(INT32_MAX)), high_above(level.size(), Int3(INT32_MIN));
    for (std::size_t group = 0; group < level.size(); ++group)
      for (std::size_t i = 0; i < kEight; ++i) {
        const std::size_t node = kEight * group + i;
        const bool empty = node >= low.size() || low[node].x > high[node].x;
        for (std::size_t k = 0; k < 3; ++k) {
          const int axis = static_cast<int>(k);
          level[group].centre[k][i] =
              empty ? kNowhere
                    : static_cast<float>((static_cast<double>(low[node][axis]) + high[node][axis]) / 2);
          level[group].half[k][i] =
              empty ? 0 : static_cast<float>((static_cast<double>(high[node][axis]) - low[node][axis]) / 2);
        }
        if (empty) continue;
        low_above[group] = glm::min(low_above[group], low[node]);
        high_above[group] = glm::max(high_above[group], high[node]);
      }
    if (level.size() <= 1) return;
    low = std::move(low_above);
    high = std::move(high_above);
  }
}

}  // namespace palpate

#pragma once
#include <array>
#include <bitset>
#include <cstdint>
#include <vector>

namespace palpate {

/// The voxels of a brick; set: boundary; bit x + 8y + 64z.
using BrickVoxels = std::bitset<512>;

/// Component of each voxel that is not boundary, numbered in the order of their first voxels, by depth-first
/// search; −1 for boundary.
inline std::array<int, 512> components_of(const BrickVoxels& boundary, int& count) {
  std::array<int, 512> component;
  component.fill(-1);
  count = 0;
  for (int seed = 0; seed < 512; ++seed) {
    if (boundary[static_cast<std::size_t>(seed)] || component[static_cast<std::size_t>(seed)] >= 0) continue;
    std::vector<int> open{seed};
    component[static_cast<std::size_t>(seed)] = count;
    while (!open.empty()) {
      const int at = open.back();
      open.pop_back();
      for (int axis = 0; axis < 3; ++axis)
        for (const int step : {-1, 1}) {
          const int along = (at >> (3 * axis) & 7) + step;
          if (along < 0 || along > 7) continue;
          const int next = at + step * (1 << (3 * axis));
          if (boundary[static_cast<std::size_t>(next)] || component[static_cast<std::size_t>(next)] >= 0)
            continue;
          component[static_cast<std::size_t>(next)] = count;
          open.push_back(next);
        }
    }
    ++count;
  }
  return component;
}

}  // namespace palpate

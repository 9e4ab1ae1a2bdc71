#pragma once
#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "compute/native/queries/pair_distance.h"
#include "compute/scene/triangle_tree.h"
#include "model/lattice/lattice_mesh.h"

namespace palpate::native {

using EightFloats = std::array<float, kLanes>;

/// Eight spheres, steps, in the frame of their body. What is none lies nowhere (kNoSphere), radius 0.
struct EightSpheres {
  std::array<EightFloats, 3> centre;
  EightFloats radius;  ///< rounded upwards
};
inline constexpr float kNoSphere = 1e30f;

/// Spheres about a tool's triangles, about its tree's runs of them, about eight runs, and so on: 19 bytes a
/// triangle. Each holds the corners of all that is below.
class ToolSpheres {
 public:
  /// Allocates.
  ToolSpheres(const LatticeMesh& tool, const TriangleTree& tree);

  /// Level 0: the triangles of a run, by its number.
  const EightSpheres& group(std::uint32_t level, std::uint32_t number) const {
    return levels_[level][number];
  }
  /// Of which there is one group; −1 as a number where the tool has no triangle.
  std::uint32_t top() const { return static_cast<std::uint32_t>(levels_.size()) - 1; }
  std::uint64_t bytes() const;

 private:
  std::vector<std::vector<EightSpheres>> levels_;
};

}  // namespace palpate::native

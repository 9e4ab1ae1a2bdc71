#pragma once
#include <cstdint>
#include <vector>

#include "compute/host_copy.h"
#include "compute/near_lists.h"
#include "compute/prepared_scene.h"
#include "model/lattice.h"

namespace palpate {

/// Which V_bnd voxels of the mock-up may hold a sample inside the tool: those near its solid, found in ever smaller cubes. The device
/// decides about each sample. One thread; find() does not allocate.
class NearSamples {
 public:
  /// The scene outlives this.
  static Result<NearSamples> make(VulkanDevice& device, const PreparedScene& scene);
  /// Appends to lists.samples, for bricks first … last of the mock-up's grid. Where it has no room, the search ends.
  void find(const LatticePose& pose, const Int3& first, const Int3& last, NearLists& lists) const;

 private:
  /// Cubes of 8³ fine voxels, with a border: whether the centre of a cube of mock-up voxels there has one of its voxels' centres near.
  struct Level {
    std::int32_t border = 0;          ///< cubes on each side of the grid
    Int3 cells{0};
    std::vector<std::uint8_t> near;
  };
  struct Search;
  Level make_level(const std::vector<std::uint8_t>& cubes, double reach) const;
  bool near_cube(const Level& level, const double (&at)[3]) const;
  bool near_voxel(const double (&at)[3]) const;
  void take_brick(Search& search, const Int3& brick, std::uint32_t slot) const;
  bool take_voxel(Search& search, const Int3& voxel, std::uint32_t boundary) const;

  gpu::GridConstants mockup_{}, fine_{};
  double per_fine_ = 0, per_cube_ = 0;   ///< fine voxels and cubes of them a step
  Level brick_, octant_;
  bool has_near_ = false, listed_ = false;
  HostCopy<std::uint32_t> slots_, near_, list_begin_, sample_begin_;
  HostCopy<gpu::Brick> bricks_;
};

}  // namespace palpate

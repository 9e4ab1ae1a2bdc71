#pragma once
#include <array>
#include <cstdint>
#include <vector>

#include "compute/host_copy.h"
#include "compute/near_lists.h"
#include "compute/prepared_scene.h"
#include "model/lattice.h"
#include "model/lattice_mesh.h"
#include "model/scene_geometry.h"

namespace palpate {

/// Goes from tool triangles near a brick to the voxels that they may touch and to the static triangles whose boxes theirs meet.
/// The device decides both exactly. One thread; nothing but make() allocates.
class NearPairs {
 public:
  static Result<NearPairs> make(VulkanDevice& device, const SceneGeometry& geometry, const PartitionBuffers& mockup);

  /// A tool triangle at a pose.
  struct Triangle {
    std::uint32_t place;             ///< in the order of clusters
    std::array<Int3, 3> corners;     ///< world lattice, exact
    std::array<double, 3> normal;    ///< raw, rounded once
    double normal_size;              ///< sum of its components' sizes
    std::array<std::uint16_t, 6> box;  ///< low and high, grown by kCloseSteps, in the boxes' steps
  };
  /// False: collinear, it meets nothing.
  bool begin(const LatticePose& pose, const LatticeMesh& tool, std::uint32_t id, std::uint32_t place, Triangle& out);
  /// Appends what lies in one brick. False: a list had no room.
  bool take(const Triangle& triangle, const Int3& brick, std::uint32_t slot, NearLists& lists);

 private:
  using Box = std::array<std::uint16_t, 6>;
  Box box_of(const Int3& low, const Int3& high) const;
  bool off_plane(const Triangle& triangle, const Int3& low, std::int32_t side) const;
  bool off_plane(const Triangle& triangle, const Box& box) const;
  bool take_list(const Triangle& triangle, std::uint32_t boundary, NearLists& lists);

  gpu::GridConstants grid_{};
  double per_voxel_ = 0;   ///< voxels a step
  double box_step_ = 1;    ///< steps
  unsigned shift_ = 0;     ///< boxes are in units of 2^shift steps
  HostCopy<gpu::Brick> bricks_;
  HostCopy<std::uint32_t> list_begin_, list_triangles_;
  std::vector<Box> boxes_;               ///< by static triangle
  std::vector<std::uint32_t> seen_by_;   ///< by static triangle: the last tool triangle that looked at it
  std::uint32_t looker_ = 0;             ///< number of the present one
};

}  // namespace palpate

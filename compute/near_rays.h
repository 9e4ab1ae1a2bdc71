#pragma once
#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "compute/host_partition.h"
#include "compute/near_lists.h"
#include "compute/prepared_scene.h"
#include "model/lattice.h"
#include "model/lattice_mesh.h"

namespace palpate {

/// Which triangles of a closed tool the rays of counting samples may cross on their way out of it: what its fine partition lists along
/// them. The device decides about each crossing. One thread; only make() allocates.
class NearRays {
 public:
  /// `order`: ids of the tool's triangles by place. Scene and tool outlive this. Only where PreparedScene::rays_walk().
  static Result<NearRays> make(VulkanDevice& device, const LatticeMesh& tool, const PreparedScene& scene, std::span<const std::uint32_t> order);

  /// The tool from the world, at a pose.
  struct Turn {
    explicit Turn(const LatticePose& pose);
    double row[3][3];
    Int3 translation;
  };
  /// One ray on its way through the tool, in its lattice frame; off by less than 2^-18 of a step.
  struct Walk {
    double next[3];       ///< parameter at the next face along each axis; t = H / 2^30
    double t = 0;         ///< at the present voxel's entry
    std::array<double, 2> shadow;   ///< where the ray lies, seen along it
    Int3 voxel{0};
    bool outside = false;   ///< it has left the grid
  };
  /// From now on rays go along this direction of the world.
  void aim(const Turn& turn, const Int3& along);
  /// The ray from a world lattice point.
  Walk begin(const Turn& turn, const Int3& point) const;
  /// Goes on to the next V_ext voxel, or out of the grid, and appends what may be crossed before (all ids once, from places[first] on, by place).
  /// False: no room. After it, crossings below stop_of(walk) are all among them.
  bool go_on(Walk& walk, std::uint32_t first, HostList<std::uint32_t>& places);
  /// Leaves V_ext voxels behind; false: the grid ends first.
  bool skip_external(Walk& walk) const;
  static std::uint32_t stop_of(const Walk& walk);

  /// Lists the ray of each sample that leaves it along −direction of its slot's area; direction 0: nothing. False: no room.
  bool find(const LatticePose& pose, std::span<const gpu::FrameSample> samples, std::span<const Int3> directions, std::span<gpu::RayList> rays,
            HostList<std::uint32_t>& places);

 private:
  /// A triangle seen along the rays: its box across them. Steps of the tool's lattice.
  struct RayShadow {
    std::array<double, 2> low{}, high{};
    bool holds(const std::array<double, 2>& ray) const { return ray[0] >= low[0] && ray[0] <= high[0] && ray[1] >= low[1] && ray[1] <= high[1]; }
  };
  std::array<double, 2> see(const double (&p)[3]) const;
  const RayShadow& shadow_of(std::uint32_t id);
  bool take_list(const Walk& ray, std::uint32_t boundary, std::uint32_t first, HostList<std::uint32_t>& places);
  void step(Walk& walk) const;

  HostPartition fine_;
  double per_voxel_ = 0;   ///< voxels a step
  const LatticeMesh* tool_ = nullptr;
  std::vector<std::uint32_t> place_of_;   ///< by id
  std::vector<RayShadow> shadows_;        ///< by id …
  std::vector<std::uint32_t> cast_in_;    ///< … and the aim they are of

  // The present aim.
  std::uint32_t aim_ = 0;
  Int3 aimed_{0};
  double along_[3] = {}, each_[3] = {};   ///< direction in the tool's frame; parameter from face to face
  std::size_t axis_ = 0;                  ///< of its largest component: rays are seen along it
  double shear_[2] = {}, beside_[2] = {};   ///< of the other two axes, in turn
};

}  // namespace palpate

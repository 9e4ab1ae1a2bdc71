#pragma once
#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "compute/host_copy.h"
#include "compute/near_lists.h"
#include "compute/prepared_scene.h"
#include "model/lattice.h"
#include "model/lattice_mesh.h"

namespace palpate {

/// Which triangles of a closed tool the rays of counting samples may cross on their way out of it: what its fine partition lists along
/// them. The device decides about each crossing. One thread; find() does not allocate.
class NearRays {
 public:
  /// `order`: ids of the tool's triangles by place. Scene and tool outlive this. Only where PreparedScene::rays_walk().
  static Result<NearRays> make(VulkanDevice& device, const LatticeMesh& tool, const PreparedScene& scene, std::span<const std::uint32_t> order);

  /// Lists the ray of each sample that leaves it along −direction of its slot's area; direction 0: nothing. False: no room.
  bool find(const LatticePose& pose, std::span<const gpu::FrameSample> samples, std::span<const Int3> directions, std::span<gpu::RayList> rays,
            HostList<std::uint32_t>& places) const;

 private:
  struct Ray;
  bool walk(const Ray& ray, gpu::RayList& out, HostList<std::uint32_t>& places) const;
  bool take_list(const Ray& ray, std::uint32_t slot, unsigned bit, std::uint32_t first, HostList<std::uint32_t>& places) const;

  using Corners = std::array<std::array<double, 3>, 3>;
  gpu::GridConstants grid_{};
  HostCopy<std::uint32_t> slots_, list_begin_, list_triangles_;
  HostCopy<gpu::Brick> bricks_;
  std::vector<std::uint32_t> place_of_;   ///< by id
  std::vector<Corners> corners_;          ///< by id, tool lattice frame
};

}  // namespace palpate

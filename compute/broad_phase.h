#pragma once
#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "compute/prepared_scene.h"
#include "model/lattice.h"
#include "model/result.h"
#include "model/scene_geometry.h"
#include "shaders/shared/frame.h"

namespace palpate {

/// Which pieces of the tool may meet the mock-up at a pose, from boxes that turn with the tool: on the host, so that a frame which
/// can't touch costs no submission, and one that can begins with what is near. Errs only towards "may meet".
/// One thread; find() neither allocates nor blocks.
class BroadPhase {
 public:
  /// `order`: the tool's triangles in the order of runs. Reads the mock-up's partition back from the device. Allocates.
  static Result<BroadPhase> make(VulkanDevice& device, const SceneGeometry& geometry, const PartitionBuffers& mockup,
                                 std::span<const std::uint32_t> order);

  struct Near {
    std::uint32_t near_triangles = 0;    ///< entries written
    bool overflow = false;           ///< there are more than fit
    bool encloses = false;           ///< a whole connected part of the mock-up may lie inside the tool
  };
  /// Tool triangles with the bricks in which they may come within kCloseSteps of a V_bnd or V_int voxel. `pose` must
  /// not be beyond the lattice.
  Near find(const LatticePose& pose, std::span<gpu::NearTriangle> out) const;

 private:
  struct Box {
    std::array<double, 3> centre, half;   ///< steps, tool lattice frame; half < 0: empty
  };
  /// Corners of a run, single precision: coordinate k of corner c of triangle i is at [3 c + k][i].
  using RunCorners = std::array<std::array<float, gpu::kRunSize>, 9>;
  struct Reach {
    std::array<double, 3> low, high;      ///< steps, world; closed
  };
  struct Turn;
  struct Search;

  void make_levels(const LatticeMesh& tool, std::span<const std::uint32_t> order);
  Result<void> read_occupancy(VulkanDevice& device, const PartitionBuffers& mockup);
  void find_parts(const LatticeMesh& mockup, std::int32_t tool_radius);
  Reach reach(const Turn& turn, const Box& box) const;
  template <class Take>
  void for_bricks(const Reach& reach, Take&& take) const;
  bool meets(const Reach& reach) const;
  void descend(Search& search, std::size_t level, std::size_t node) const;
  void take_run(Search& search, std::size_t run) const;

  /// Boxes of runs, of 8 runs, of 64 …; the last level is the whole tool.
  std::vector<std::vector<Box>> levels_;
  std::vector<RunCorners> runs_;
  std::int32_t tool_radius_ = 0;
  gpu::GridConstants grid_{};
  double per_voxel_ = 0;   ///< voxels a step
  std::vector<std::uint32_t> slots_;                        ///< by brick, as brick_slot
  std::vector<std::array<std::uint64_t, 8>> occupied_;      ///< by slot and z: bit x + 8y of a voxel that is not V_ext
  /// Parts of the mock-up that would fit into the tool.
  std::vector<std::array<std::int32_t, 6>> parts_;          ///< low x, y, z, high x, y, z; steps
};

}  // namespace palpate

#pragma once
#include <cstdint>
#include <memory>
#include <span>
#include <vector>

#include "compute/native/broad_phase/candidates.h"
#include "compute/scene/brick_bits.h"
#include "compute/scene/samples.h"
#include "compute/scene/scene_tables.h"
#include "model/lattice/lattice.h"
#include "model/scene/scene_geometry.h"

namespace palpate {

/// Which samples of the mock-up may lie inside the tool: those in V_bnd voxels near its solid, found in ever
/// smaller cubes. Where samples are listed, the tool's fine partition answers for most of them here; the
/// device decides about the rest. One thread; find() does not allocate.
class CandidateSamples {
 public:
  /// Geometry and scene outlive this.
  static CandidateSamples make(const SceneGeometry& geometry, const SceneTables& scene);
  /// Appends to lists.inside and open, or to lists.samples, for bricks first … last of the mock-up's grid.
  /// Where it has no room, the search ends.
  void find(const LatticePose& pose, const Int3& first, const Int3& last, Candidates& lists) const;

 private:
  /// Cubes of 8³ fine voxels, with a border: whether the centre of a cube of mock-up voxels there has one of
  /// its voxels' centres near.
  struct Level {
    std::int32_t border = 0;  ///< cubes on each side of the grid
    Int3 cells{0};
    std::vector<std::uint8_t> near;
  };
  struct Search;
  Level make_level(const std::vector<std::uint8_t>& cubes, double reach) const;
  bool near_cube(const Level& level, const double (&at)[3]) const;
  void take_brick(Search& search, const Int3& brick, std::uint32_t slot) const;
  bool take_voxel(Search& search, const Int3& voxel, std::uint32_t boundary) const;
  bool take_listed(Search& search, const Int3& voxel, std::uint32_t boundary) const;
  std::uint32_t fine_class(const Int3& p) const;

  gpu::GridConstants mockup_{}, fine_{};
  double per_fine_ = 0, per_cube_ = 0;  ///< fine voxels and cubes of them a step
  Level brick_, octant_;
  bool has_near_ = false, listed_ = false;
  std::span<const std::uint32_t> slots_, near_, list_begin_, list_triangles_;
  std::span<const gpu::Brick> bricks_;
  BrickBits solid_, internal_;  ///< the tool's fine voxels that are not V_ext, those that are V_int
  const LatticeMesh* mesh_ = nullptr;
  std::int32_t spacing_ = 1;
  std::shared_ptr<const HostSamples> sampled_;
};

}  // namespace palpate

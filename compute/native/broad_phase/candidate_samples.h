#pragma once
#include <cstdint>
#include <memory>
#include <span>
#include <vector>

#include "compute/native/broad_phase/candidates.h"
#include "compute/native/broad_phase/solid_bits.h"
#include "compute/native/narrow_phase/open_inside.h"
#include "compute/scene/samples.h"
#include "compute/scene/scene_tables.h"
#include "model/bytes_of.h"
#include "model/lattice/lattice.h"
#include "model/scene/scene_geometry.h"

namespace palpate {

/// Which samples of the mock-up may lie inside the tool: those in V_bnd voxels near its solid, found in ever
/// smaller cubes. Where samples are listed, the tool's fine partition, or cells of its voxels, answers for
/// most of them here; the device decides about the rest. One thread; find() does not allocate.
class CandidateSamples {
 public:
  /// Geometry and scene outlive this.
  static CandidateSamples make(const SceneGeometry& geometry, const SceneTables& scene);
  /// Of a tool that is not closed: what is known of `partition`, its own one. Allocates.
  void use(std::shared_ptr<const OpenInside> known, const PartitionView& partition);
  /// Appends to lists.inside and open, or to lists.samples, for bricks first … last of the mock-up's grid.
  /// Where it has no room, the search ends.
  void find(const LatticePose& pose, const Int3& first, const Int3& last, Candidates& lists) const;
  /// But for what is shared.
  std::uint64_t bytes() const {
    return bytes_of(brick_.near) + bytes_of(octant_.near) + cubes_.solid.bytes();
  }

 private:
  /// Cubes of 8³ of Near's, with a border: whether the centre of a cube of mock-up voxels there has one of
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
  std::uint32_t class_at(const Int3& p) const;

  /// Cubes of the tool's grid: its fine voxels, or quarters of its voxels.
  struct Near {
    Int3 origin{0};
    double per_step = 1;                  ///< cubes a step
    Int3 bricks{0};                       ///< of 8³ of them
    std::span<const std::uint32_t> bits;  ///< by cube: a mock-up voxel's centre there is near; empty: all are
  };
  void use(const Near& near);

  gpu::GridConstants mockup_{};
  Near near_;
  Level brick_, octant_;
  bool listed_ = false;
  std::span<const std::uint32_t> slots_, list_begin_, list_triangles_;
  std::span<const gpu::Brick> bricks_;
  /// Cubes that say of points whether they lie in the tool: its fine voxels, or cells of its voxels.
  struct Cubes {
    Int3 origin{0};
    double per_step = 1;  ///< cubes a step
    Int3 bricks{0};       ///< of 8³ of them
    SolidBits solid;
  };
  Cubes cubes_;
  const LatticeMesh* mesh_ = nullptr;
  std::int32_t spacing_ = 1;
  std::shared_ptr<const VoxelSamples> sampled_;
  std::shared_ptr<const OpenInside> known_;  ///< near_ may be its
};

}  // namespace palpate

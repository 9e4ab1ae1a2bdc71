#pragma once
#include <array>
#include <cstdint>
#include <memory>
#include <vector>

#include "compute/native/prepare/touched_voxels.h"
#include "compute/native/queries/distance_lattice.h"
#include "compute/native/queries/tool_spheres.h"
#include "compute/scene/exact.h"
#include "model/lattice/lattice.h"
#include "model/lattice/lattice_mesh.h"
#include "model/lattice/voxel_grid.h"
#include "model/scene/scene_geometry.h"

namespace palpate::native {

/// How far what lies in a cell of a grid is from a body's surface at least: a number for each cell of the
/// bricks near it, and one for each brick elsewhere; further off a coarse lattice says more. Made once a
/// scene, read by any number of threads. A brick's cells are worked out by whoever first comes there: a
/// path or a few poses see few of them.
class RoomField {
 public:
  /// Of a scene's mock-up: in cells of a quarter of its voxel, or of twice, four times … that where they
  /// would take more than most_bytes(). `tree`: of all its triangles that did not collapse.
  static RoomField of(const SceneGeometry& geometry, const TriangleTree& tree);
  /// What bytes() of a scene's field is at most, known before it is made: the bricks that its surface may
  /// touch and those around them, but no more than 64 MiB and 64 bytes a triangle.
  static std::uint64_t most_bytes(const SceneGeometry& geometry);
  /// The same while it is made.
  static std::uint64_t most_bytes_made(const SceneGeometry& geometry);

  /// A pose in cells.
  struct Turn {
    float rotation[3][3], at[3];
    float slack;  ///< steps, by which a centre may be off
  };
  Turn turn(const LatticePose& pose, double tool_radius) const;

  /// Of eight spheres of the tool at a pose: squares of what their centres are from the surface at least, in
  /// cells.
  void rooms(const Turn& turn, const EightSpheres& spheres, EightFloats& squared) const;
  /// Steps that a sphere is from the surface at least, below 0 where that may be inside it.
  double room(const Turn& turn, float squared, float radius) const;
  /// Where the centre of one of eight is, in the world, but for turn.slack.
  std::array<double, 3> centre(const Turn& turn, const EightSpheres& spheres, std::size_t i) const;
  /// The same as room() of one of eight, which `squared` says is far: as far as the lattice knows.
  double far_room(const Turn& turn, const EightSpheres& spheres, std::size_t i, float squared) const;
  /// Squared cells from which on the lattice may know more.
  static constexpr float kFarSquared = 64;

  /// Steps that a point is from the surface at least.
  double room_at(const std::array<double, 3>& point) const;
  /// Side of a cell, steps.
  double cell_steps() const { return grid_.size; }

  /// Whether all of a triangle, in the world, is further from the surface than so many steps, as far as the
  /// field can tell.
  bool all_beyond(const exact::Corners& triangle, double steps) const;

  /// Steps beyond which all_beyond() knows little that room() does not.
  double detail_steps() const;

  std::uint64_t bytes() const {
    return sizeof place_[0] * std::uint64_t{place_.size()} +
           (sizeof(Cells) + sizeof touched_[0]) * std::uint64_t{touched_.size()} + lattice_.bytes();
  }

 private:
  /// `away`: by brick of the grid, how many it is from one that the surface touches; of so many, `count`,
  /// that is 0 or 1.
  RoomField(const LatticeMesh& mesh, const VoxelGrid& grid, std::vector<std::int32_t> away, std::size_t count,
            DistanceLattice lattice);
  using Cells = std::array<std::uint8_t, 512>;  ///< of a brick: sixteenths of a cell, x + 8 y + 64 z

  float gap(std::size_t brick, std::size_t cell) const;
  float gap_of_new(std::size_t brick, std::int32_t place, std::size_t cell) const;
  void work_out(std::size_t brick, Cells& out) const;

  VoxelGrid grid_{};
  double per_cell_ = 0;  ///< cells a step
  /// By brick: where its cells are in `near_`; below 0 minus so many cells, or kNew, or kTaken, less its
  /// place there. Any thread takes it from kNew by kTaken to its place.
  mutable std::vector<std::int32_t> place_;
  std::vector<BrickBits> touched_;  ///< of the bricks in `near_`
  std::unique_ptr<Cells[]> near_;   ///< of whatever has a place
  DistanceLattice lattice_;
};

}  // namespace palpate::native

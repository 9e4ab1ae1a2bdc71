#pragma once
#include <array>
#include <cstdint>
#include <vector>

#include "compute/native/queries/tool_spheres.h"
#include "compute/scene/exact.h"
#include "compute/scene/partition.h"
#include "model/lattice/lattice.h"
#include "model/scene/scene_geometry.h"

namespace palpate::native {

/// How far what lies in a cell of a grid is from a body's surface at least: a number for each cell of the
/// bricks near it, and one for each brick elsewhere. Made once a scene, read by any number of threads.
class RoomField {
 public:
  /// Of a scene's mock-up: in cells of a quarter of its voxel, or of twice, four times … that where the
  /// bricks near it would take more than 64 MiB and 64 bytes a triangle.
  static RoomField of(const SceneGeometry& geometry);
  /// `surface`: whose V_bnd voxels are the cells that the surface touches. Allocates 512 bytes for each brick
  /// that has one or lies next to it, four for each other; on all cores.
  explicit RoomField(const Partition& surface);

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

  /// Whether all of a triangle, in the world, is further from the surface than so many steps, as far as the
  /// field can tell.
  bool all_beyond(const exact::Corners& triangle, double steps) const;

  std::uint64_t bytes() const {
    return sizeof place_[0] * std::uint64_t{place_.size()} + sizeof near_[0] * std::uint64_t{near_.size()};
  }

 private:
  double room_at(const double (&point)[3]) const;
  using Cells = std::array<std::uint8_t, 512>;  ///< of a brick: sixteenths of a cell, x + 8 y + 64 z

  gpu::GridConstants grid_{};
  double per_cell_ = 0;              ///< cells a step
  std::vector<std::int32_t> place_;  ///< by brick: in `near_`; below 0: minus so many cells
  std::vector<Cells> near_;
};

}  // namespace palpate::native

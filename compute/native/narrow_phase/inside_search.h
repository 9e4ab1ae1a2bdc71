#pragma once
#include <cstdint>
#include <memory>
#include <span>
#include <utility>
#include <vector>

#include "compute/native/narrow_phase/open_inside.h"
#include "compute/scene/partition_lookup.h"
#include "model/bytes_of.h"
#include "model/lattice/lattice_mesh.h"

namespace palpate {

/// Whether a lattice point lies inside a body that does not move, in the body's own frame (docs/EXACTNESS.md
/// section 4): of a closed one by walks along axes to voxels that list nothing, of any other by what is known
/// of its voxels (OpenInside). Arguments outlive this. One thread, but of a body that is not closed any
/// number; only the constructor allocates.
class InsideSearch {
 public:
  InsideSearch() = default;
  /// `partition` lists every triangle of `mesh` in every voxel that it touches; `boxes`: SearchTables::boxes
  /// of it.
  InsideSearch(const LatticeMesh& mesh, const PartitionLookup& partition,
               std::span<const std::uint8_t> boxes);

  bool inside(const Int3& point);
  /// The same of many points of a body that is not closed: answers[i] is 1 where points[i] lies inside. What
  /// all of them read is called for before the first is answered, for it lies far apart. At most kMostPoints.
  void inside(std::span<const Int3> points, std::span<std::uint8_t> answers);
  static constexpr std::size_t kMostPoints = 256;
  /// Before a body that is not closed is asked anything. `known` is of the same body and partition.
  void use(std::shared_ptr<const OpenInside> known) { known_ = std::move(known); }
  /// But for what is shared.
  std::uint64_t bytes() const { return bytes_of(way_) + bytes_of(windings_); }
  /// How many shells a point in a V_bnd voxel, of number `boundary`, of a body that is not closed is in.
  int shells_at(const Int3& point, const Int3& voxel, std::uint32_t boundary) const;
  /// What is left of the weight of a sample at a point that lies inside a body that is not closed, where
  /// neighbouring voxels may say otherwise (section 4, "Doubt").
  std::uint32_t sure(std::uint32_t weight, const Int3& point) const;
  /// What OpenShells asks.
  OpenShells::Halves halves_of(const Int3& voxel, std::uint32_t boundary) const;

 private:
  struct Walk {
    int net;             ///< Σ of the signs of what is crossed
    Int3 voxel;          ///< where it ends
    std::uint32_t kind;  ///< of that voxel
  };
  bool inside_boundary(const Int3& point, const Int3& voxel, std::uint32_t boundary);
  Walk walk(const Int3& point, const Int3& voxel, int axis, int way) const;
  int crossed(const Int3& from, const Int3& to, int axis, const Int3& voxel, std::uint32_t boundary,
              bool sheets) const;
  int crossed_within(const Int3& from, const Int3& to, const Int3& voxel, std::uint32_t boundary) const;
  using Parts = Int3;  ///< of a voxel, from its low corner on: kVoxelParts a side
  template <class Take>
  void for_listed(std::uint32_t boundary, const Parts& low, const Parts& high, Take&& take) const;
  std::uint8_t shortest_way(const Int3& voxel) const;
  int winding_of(const Int3& voxel);

  const LatticeMesh* mesh_ = nullptr;
  const PartitionLookup* partition_ = nullptr;
  std::span<const std::uint8_t> boxes_;
  double per_part_ = 0;                      ///< parts of a voxel a step
  std::shared_ptr<const OpenInside> known_;  ///< of a body that is not closed
  std::vector<std::uint8_t> way_;  ///< by V_bnd voxel of a closed body: the shortest way out of such voxels,
                                   ///< axis · 2 + up + 1; 0: not known yet
  struct Known {
    std::uint64_t voxel;  ///< its number + 1; 0: nothing
    int winding;
  };
  std::vector<Known> windings_;  ///< of V_int voxels in which walks ended: a table where a newer answer takes
                                 ///< an older one's place
};

}  // namespace palpate

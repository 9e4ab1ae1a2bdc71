#pragma once
#include <cstdint>
#include <vector>

#include "compute/cell_memo.h"
#include "compute/host_partition.h"
#include "model/lattice_mesh.h"

namespace palpate {

/// How far a point lies below a body's surface (docs/EXACTNESS.md section 4), on the host: through the voxels round the point, nearest first, as far as something
/// may still be nearer. Geometry and partition outlive this. One thread; only the constructor allocates.
class DepthSearch {
 public:
  struct Depth {
    std::uint32_t steps;      ///< φ
    std::uint32_t triangle;   ///< the nearest one, kNobody: there is none
  };
  static constexpr std::uint32_t kNobody = UINT32_MAX;

  DepthSearch() = default;
  /// `partition` lists every triangle of `mesh` in every voxel that it touches.
  DepthSearch(const LatticeMesh& mesh, const HostPartition& partition) : mesh_(&mesh), partition_(&partition) {}

  Depth below(const Int3& point) const;

 private:
  struct Search;
  void look_at(Search& search, std::uint32_t triangle) const;
  void look_into(Search& search, const Int3& voxel) const;

  const LatticeMesh* mesh_ = nullptr;
  const HostPartition* partition_ = nullptr;
};

/// Whether a lattice point lies inside a body that does not move, in the body's own frame (docs/EXACTNESS.md section 4). One thread; only make() allocates.
class InsideSearch {
 public:
  InsideSearch() = default;
  InsideSearch(const LatticeMesh& mesh, const HostPartition& partition) : mesh_(&mesh), partition_(&partition), cells_(partition.grid().boundary_voxels) {}

  bool inside(const Int3& point);

 private:
  bool by_winding(const Int3& point, const Int3& voxel) const;
  bool by_walks(const Int3& point, const Int3& voxel) const;

  const LatticeMesh* mesh_ = nullptr;
  const HostPartition* partition_ = nullptr;
  CellMemo cells_;   ///< of V_bnd voxels of a closed body
};

}  // namespace palpate

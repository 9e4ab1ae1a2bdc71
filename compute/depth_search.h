#pragma once
#include <cstdint>
#include <span>
#include <vector>

#include "compute/host_partition.h"
#include "model/lattice_mesh.h"

namespace palpate {

/// How far a point lies below a body's surface (docs/EXACTNESS.md section 4), on the host: through the voxels round the point, nearest first, as far as something
/// may still be nearer, and in each of them through those triangles alone whose boxes are near enough. What it has worked out of triangles it keeps, as far as there is
/// room. Arguments outlive this. One thread; only making and copying one allocates.
class DepthSearch {
 public:
  struct Depth {
    std::uint32_t steps;      ///< φ
    std::uint32_t triangle;   ///< the nearest one, kNobody: there is none
  };
  static constexpr std::uint32_t kNobody = UINT32_MAX;

  DepthSearch();
  DepthSearch(const DepthSearch&);
  DepthSearch& operator=(const DepthSearch&);
  ~DepthSearch();
  /// `partition` lists every triangle of `mesh` in every voxel that it touches; `boxes`: SearchTables::boxes of it.
  DepthSearch(const LatticeMesh& mesh, const HostPartition& partition, std::span<const std::uint8_t> boxes);

  /// `guess`: a triangle that may be near, as the one of a point beside it; kNobody: none. It changes nothing but the time.
  Depth below(const Int3& point, std::uint32_t guess);

 private:
  struct Search;
  struct Known;
  static constexpr std::uint32_t kKnown = 4096;   // triangles (chosen: 1 MiB, what a second-level cache holds)
  Known& know(std::uint32_t triangle);
  std::int64_t distance_to(const Int3& point, Known& known, std::int64_t height, unsigned mask) const;
  void look_at(Search& search, std::uint32_t triangle);
  void look_into(Search& search, const Int3& voxel, std::uint32_t boundary);
  void look_round(Search& search);

  const LatticeMesh* mesh_ = nullptr;
  const HostPartition* partition_ = nullptr;
  std::span<const std::uint8_t> boxes_;
  double per_part_ = 0;   ///< parts of a voxel a step
  std::vector<Known> known_;   ///< by triangle, where a newer one takes an older one's place
};

/// Whether a lattice point lies inside a body that does not move, in the body's own frame (docs/EXACTNESS.md section 4): by walks along axes to voxels that list nothing,
/// of a body that is not closed once a voxel. Arguments outlive this. One thread; only the constructor allocates.
class InsideSearch {
 public:
  InsideSearch() = default;
  /// As for DepthSearch.
  InsideSearch(const LatticeMesh& mesh, const HostPartition& partition, std::span<const std::uint8_t> boxes);

  bool inside(const Int3& point);

 private:
  struct Walk {
    int net;              ///< Σ of the signs of what is crossed
    Int3 voxel;           ///< where it ends
    std::uint32_t kind;   ///< of that voxel
  };
  bool inside_boundary(const Int3& point, const Int3& voxel, std::uint32_t boundary);
  Walk walk(const Int3& point, const Int3& voxel, int axis, int way, bool sheets) const;
  int crossed(const Int3& from, const Int3& to, int axis, const Int3& voxel, std::uint32_t boundary, bool sheets) const;
  int crossed_within(const Int3& from, const Int3& to, const Int3& voxel, std::uint32_t boundary) const;
  std::int16_t winding_by_walks(const Int3& voxel) const;
  std::uint8_t shortest_way(const Int3& voxel) const;
  int winding_of(const Int3& voxel);

  const LatticeMesh* mesh_ = nullptr;
  const HostPartition* partition_ = nullptr;
  std::span<const std::uint8_t> boxes_;
  double per_part_ = 0;                    ///< parts of a voxel a step
  std::vector<std::uint8_t> way_;          ///< by V_bnd voxel of a closed body: the shortest way out of such voxels, axis · 2 + up + 1; 0: not known yet
  static constexpr std::int16_t kUnknown = INT16_MIN;
  std::vector<std::int16_t> middle_;       ///< by V_bnd voxel of a body that is not closed: how deep in its middle is, in shells
  struct Known {
    std::uint64_t voxel;                   ///< its number + 1; 0: nothing
    int winding;
  };
  std::vector<Known> windings_;            ///< of V_int voxels in which walks ended: a table where a newer answer takes an older one's place
};

}  // namespace palpate

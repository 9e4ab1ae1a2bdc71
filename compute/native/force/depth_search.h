#pragma once
#include <cstdint>
#include <memory>

#include "compute/scene/triangle_tree.h"
#include "model/lattice/lattice_mesh.h"

namespace palpate {

/// How far a point lies below a body's surface (docs/EXACTNESS.md section 4), on the host: down the body's
/// tree, eight boxes or triangles at a time in single precision, which only sorts out; what is left, integers
/// decide. What it has worked out of triangles, and where in the tree points of a cube have what is near, it
/// keeps, as far as there is room. Arguments outlive this. One thread; only making one allocates.
class DepthSearch {
 public:
  struct Depth {
    std::uint32_t steps;     ///< φ
    std::uint32_t triangle;  ///< the nearest one, kNobody: there is none
    std::uint32_t place;     ///< of it in the tree; kNobody: there is none
  };
  static constexpr std::uint32_t kNobody = UINT32_MAX;

  DepthSearch();
  DepthSearch(DepthSearch&&) noexcept;
  DepthSearch& operator=(DepthSearch&&) noexcept;
  ~DepthSearch();
  /// `tree` is the mesh's. `spacing`, steps: points that are asked one after the other are often so close. It
  /// changes nothing but the time.
  DepthSearch(const LatticeMesh& mesh, const TriangleTree& tree, std::int32_t spacing);

  /// The point is within ±2^30. `guess`: the place of a triangle that may be near, as for a point beside it;
  /// kNobody: none. It changes nothing but the time.
  Depth below(const Int3& point, std::uint32_t guess);
  /// The unit way from a point to the nearest one of a triangle that is `steps` away, Q30 (EXACTNESS section
  /// 4, "Way out").
  Int3 way_out(const Int3& point, std::uint32_t triangle, std::uint32_t steps);
  /// How many groups of eight boxes or triangles it has looked at in all.
  std::uint64_t looks() const;
  std::uint64_t bytes() const;

  struct Tables;  ///< depth_search.cpp's own

 private:
  std::unique_ptr<Tables> tables_;
};

}  // namespace palpate

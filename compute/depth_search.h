#pragma once
#include <cstdint>
#include <vector>

#include "compute/triangle_tree.h"
#include "model/lattice_mesh.h"

namespace palpate {

/// How far a point lies below a body's surface (docs/EXACTNESS.md section 4), on the host: down the body's tree, eight boxes or triangles at a time in single precision,
/// which only sorts out; what is left, integers decide. What it has worked out of triangles it keeps, as far as there is room. Arguments outlive this. One thread; only
/// making and copying one allocates.
class DepthSearch {
 public:
  struct Depth {
    std::uint32_t steps;      ///< φ
    std::uint32_t triangle;   ///< the nearest one, kNobody: there is none
    std::uint32_t place;      ///< of it in the tree; kNobody: there is none
  };
  static constexpr std::uint32_t kNobody = UINT32_MAX;

  DepthSearch();
  DepthSearch(const DepthSearch&);
  DepthSearch& operator=(const DepthSearch&);
  ~DepthSearch();
  /// `tree` is the mesh's.
  DepthSearch(const LatticeMesh& mesh, const TriangleTree& tree);

  /// The point is within ±2^30. `guess`: the place of a triangle that may be near, as for a point beside it; kNobody: none. It changes nothing but the time.
  Depth below(const Int3& point, std::uint32_t guess);

 private:
  struct Search;
  struct Run;
  struct Known;
  static constexpr std::uint32_t kRuns = 512;     // runs of triangles (chosen: 600 KiB)
  static constexpr std::uint32_t kKnown = 1024;   // triangles (chosen: 220 KiB)
  const Run& run(std::uint32_t number);
  Known& know(std::uint32_t triangle);
  std::int64_t distance_to(const Int3& point, std::uint32_t triangle);
  std::int64_t height_above(const Int3& point, std::uint32_t triangle) const;
  void look_at(Search& search, std::uint32_t place, bool above);
  template <class Lanes>
  void look_into(Search& search, std::uint32_t run, Lanes lanes);
  template <class Lanes>
  void descend(Search& search, std::uint32_t guess, Lanes lanes);

  const LatticeMesh* mesh_ = nullptr;
  const TriangleTree* tree_ = nullptr;
  std::vector<Run> runs_;      ///< by run, where a newer one takes an older one's place
  std::vector<Known> known_;   ///< by triangle, likewise
};

}  // namespace palpate

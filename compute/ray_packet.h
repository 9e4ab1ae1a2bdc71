#pragma once
#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "compute/posed_tool.h"
#include "compute/ray_shadows.h"
#include "compute/run_tree.h"
#include "model/lattice_mesh.h"

namespace palpate {

/// Rays of one direction through the whole tool at once: sorted into squares across them, so that every triangle that may lie before them is tested
/// against those in the squares it covers, in doubles. One thread; trace() allocates only for more rays or crossings than ever before.
class RayPacket {
 public:
  /// `runs`: of the tool. Both outlive this.
  RayPacket(const LatticeMesh& tool, const RunTree& runs);

  /// What a ray may cross: a crossing, or sign 0 where doubles don't tell and exact::ray_crossing has to.
  struct Hit {
    std::uint32_t id;       ///< of a triangle
    std::int32_t sign;
    std::uint32_t height;
    std::uint32_t next;     ///< of the same ray
  };
  /// Rays from these points, at least one, of the world lattice along `along`, its largest |component| in [2^28, 2^29). False: to walk from each (NearRays) costs
  /// less, or takes less memory.
  bool trace(PosedTool& tool, std::span<const Int3> points, const Int3& along);
  /// After trace(): calls take(hit), each triangle once, for all that the ray from point `i` crosses.
  template <class Take>
  void for_hits(std::size_t i, Take&& take) const {
    for (std::uint32_t hit = first_hit_[i]; hit != kNoHit; hit = hits_[hit].next) take(hits_[hit]);
  }

 private:
  static constexpr std::uint32_t kNoHit = UINT32_MAX;
  struct Begin {
    double x, y;
    std::int32_t z;
    std::uint32_t square;
  };
  void sort(std::span<const Int3> points, const Int3& origin);
  bool holds_rays(const std::array<std::int32_t, 2>& first, const std::array<std::int32_t, 2>& last) const;
  bool find_runs(const LatticePose& pose);
  void test_run(PosedTool& tool, std::uint32_t run);
  void note(std::uint32_t ray, std::size_t i, std::uint32_t id);

  const LatticeMesh* tool_;
  const RunTree* tree_;
  double tool_reach_ = 0;   ///< steps: no component of a turned vertex is beyond it

  // The present rays.
  std::array<std::size_t, 3> axes_{};   ///< of x, y and z (RayView)
  double height_a_step_ = 1;    ///< along z
  RayView view_;
  EightShadows eight_;
  std::size_t columns_ = 1, rows_ = 1;             ///< of squares
  std::vector<Begin> begins_;                      ///< by ray
  std::vector<std::uint32_t> first_;               ///< of each square; and one more
  std::vector<std::uint32_t> number_;              ///< rays by square …
  std::vector<double> x_, y_;                      ///< … where they lie …
  std::vector<std::int32_t> z_;                    ///< … and begin
  std::vector<std::uint32_t> runs_;                ///< of triangles before the rays
  std::size_t rows_tested_ = 0;
  std::vector<std::uint32_t> met_;                 ///< rays that a triangle may meet
  std::vector<std::uint32_t> first_hit_;           ///< by ray
  std::vector<Hit> hits_;
};

}  // namespace palpate

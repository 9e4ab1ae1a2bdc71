#pragma once
#include <cstdint>
#include <vector>

#include "model/lattice/lattice_mesh.h"

namespace palpate {

/// The generalised winding number of a mesh that need not be closed: the solid angle that it fills as seen
/// from a point, by 4π. Inside a closed surface it is 1, outside 0, and between them where the surface has
/// holes (Jacobson, Kavan, Sorkine-Hornung 2013). What is far is taken together, as one dipole (Barill et al.
/// 2018), so it is an estimate in double precision, off by up to 0.05 near real bodies (measured on four):
/// for people to look at, no force hangs on it. Of the triangles that neither collapsed nor are of a sheet.
class WindingNumber {
 public:
  explicit WindingNumber(const LatticeMesh& mesh);

  /// At a point, lattice steps, in the mesh's own frame. On a triangle: as on one of its sides.
  double at(const Vec3& point) const;

 private:
  static constexpr std::size_t kWide = 8;
  struct Cluster {
    Vec3 centre{0};        ///< of its triangles' area
    Vec3 area{0};          ///< Σ N / 2
    double size = 0;       ///< Σ |N| / 2
    double radius = 0;     ///< about `centre`, of what holds them
    Int3 low{0}, high{0};  ///< of a box about them
  };
  const LatticeMesh* mesh_;           ///< outlives this
  std::vector<std::uint32_t> order_;  ///< triangles, so that those that follow each other are near each other
  std::vector<std::vector<Cluster>>
      levels_;  ///< 0: of kWide triangles each; above, of kWide of the level below
};

}  // namespace palpate

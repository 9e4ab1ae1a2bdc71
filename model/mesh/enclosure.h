#pragma once
#include <cstdint>
#include <memory>
#include <vector>

#include "model/lattice/lattice_mesh.h"
#include "model/mesh/mesh.h"
#include "model/mesh/winding_number.h"
#include "model/result.h"

namespace palpate {

/// How far a body closes round its own triangles: of a closed one, and of one that only has gaps, there is
/// an inside next to nearly every triangle; next to a sheet there is none. Copies of a triangle count once.
/// Told by the winding number half-way between a triangle's two sides: 1/2 where they lie in and out, a whole
/// number where they lie alike.
class Enclosure {
 public:
  /// Errors (kBadValue) as snap_and_weld().
  static Result<Enclosure> of(const Mesh& mesh);

  /// Of a triangle, from 0 (a sheet) to 1/2 (a closed body). An estimate, as WindingNumber is.
  double at(std::uint32_t number) const;
  /// Leaves triangles out, for they are a sheet: one in a body, or beside it, makes it look less closed.
  void take_for_sheets(const std::vector<std::uint32_t>& numbers);
  /// Its area, in units of its own.
  double area(std::uint32_t number) const;

 private:
  Enclosure(LatticeMesh mesh, std::vector<std::uint32_t> places);
  std::unique_ptr<LatticeMesh> mesh_;
  WindingNumber winding_;
  std::vector<std::uint32_t> places_;  ///< by triangle of the body, in `mesh_`, which has no copies
};

}  // namespace palpate

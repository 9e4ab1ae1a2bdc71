#pragma once
#include <array>
#include <cstdint>
#include <functional>
#include <string>
#include <utility>
#include <vector>

#include "model/generate/solids.h"
#include "model/lattice/pose.h"
#include "model/mesh/mesh.h"

/// Solids that can be tessellated as finely as asked, and the sharing of a number of triangles among them.
namespace palpate::pieces {

/// A stretch of a grid line that is divided evenly.
struct Span {
  double length = 0;        ///< m, decides into how many cells it is divided
  std::uint32_t least = 1;  ///< cells even when coarsest
};

/// Place on a grid line: span `span`, `step` of `steps` cells along it.
struct GridPlace {
  std::size_t span = 0;
  std::uint32_t step = 0, steps = 1;
  double fraction() const { return static_cast<double>(step) / static_cast<double>(steps); }
};

using Divisions = std::vector<std::uint32_t>;  ///< cells, one number a span

/// One closed solid of a scene.
struct Piece {
  std::string name;
  double fineness = 1;  ///< edge of its cells, relative to the scene's; 0: never divided
  std::vector<Span> spans;
  std::function<std::uint64_t(const Divisions&)> count;  ///< triangles it will have
  std::function<Mesh(const Divisions&)> make;
};

/// Box; `fineness` 0 makes a plate as CAD systems do: two triangles a face.
Piece block(std::string name, const Vec3& min, const Vec3& max, double fineness, const Pose& pose = {});

/// A grid of `around` × `along` spans (solids::loft says which way round is outward).
Piece lofted(std::string name, double fineness, const std::vector<Span>& around,
             const std::vector<Span>& along, solids::Ends ends,
             const std::function<Vec3(const GridPlace& around, const GridPlace& along)>& point);

/// A section in the (y, z) plane of a frame that moves along its own x; closed at both ends by shrinking the
/// section to the frame's origin. The section runs counter-clockwise seen from +x.
Piece swept(std::string name, double fineness, const std::vector<Span>& section_spans,
            const std::function<std::pair<double, double>(const GridPlace&)>& section,
            const std::vector<Span>& spine_spans, const std::function<Pose(const GridPlace&)>& spine,
            double cap_m);

/// A plate of thickness `thickness` along x with an opening: two outlines in (y, z), counter-clockwise seen
/// from +x, corner i of the one joined to corner i of the other. `round_inside`: the inner one is a circle
/// through its corners.
Piece framed_opening(std::string name, double fineness, std::vector<std::pair<double, double>> inner,
                     std::vector<std::pair<double, double>> outer, bool round_inside, double thickness,
                     const Pose& pose);

/// Cylinder along z from 0 to `height`.
Piece cylinder(std::string name, double fineness, double radius, double height, std::uint32_t least_segments,
               const Pose& pose);

/// Torus about z.
Piece torus(std::string name, double fineness, double ring_radius, double tube_radius, const Pose& pose);

/// Tessellates all pieces so that together they have `triangles`, or one less when that is odd. Pieces from
/// the end of the list are left out while even the coarsest tessellation of all needs more than nine tenths
/// of `triangles`.
Mesh tessellate(std::vector<Piece> pieces, std::uint64_t triangles);

}  // namespace palpate::pieces

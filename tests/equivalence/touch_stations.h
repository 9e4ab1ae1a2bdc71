#pragma once
#include <cstdint>
#include <string>
#include <vector>

#include "model/result.h"
#include "tests/equivalence/case.h"
#include "tests/equivalence/lattice_shapes.h"
#include "tests/equivalence/random.h"

namespace palpate::equivalence {

/// How one static triangle meets the tool's only triangle when the tool is brought to it. Each holds by an
/// argument in touch_stations.cpp, not by a test of triangles.
enum class Touch : std::uint8_t {
  kVertexVertex,
  kVertexEdge,
  kVertexFace,  ///< tool's feature first
  kEdgeVertex,
  kEdgeEdge,
  kEdgeEdgeBetweenPoints,
  kEdgeSliding,
  kEdgeFace,
  kFaceVertex,
  kFaceEdge,
  kCoplanarOverlap,
  kCoplanarVertexOnEdge,
  kCoplanarSharedEdge,
  kCoplanarApart,
  kIdentical,
  kCount
};

/// A static triangle and how the tool is brought to it.
struct Station {
  Touch touch{};
  LatticeTriangle triangle{};
  LatticePose pose;   ///< quarter turns and the station's place
  bool meets = true;  ///< whether the two intersect at `pose`
  Int3 apart{0};      ///< one lattice step, tool's frame, after which they do not
  Int3 into{0};       ///< one lattice step after which they still do; 0: none is known
};

/// Shape of the tool's triangle, from whose corners everything is made: in eighths of its edges, so corners
/// differ by multiples of 8.
struct TouchShape {
  Int3 p{0}, q{0};  ///< from the first corner to the others, steps, multiples of 8, not parallel
  Int3 w{0};        ///< out of the triangle's plane, multiples of 8: where static triangles lie
};

/// How stations are laid out.
struct TouchLayout {
  int count = 8;
  bool slender =
      false;  ///< the shape is long along x alone: stations lie side by side along y, and turn together
  std::int32_t voxel = 0;  ///< 0: a quarter of the way between stations
  int corner = 0;          ///< −1, +1: pushed into that corner of the lattice; 0: about its middle
};

/// A scene of stations, each so far from the others that a tool brought to one, or a step beside it, meets no
/// other.
struct TouchScene {
  Triangles mockup, tool;
  std::vector<Station> stations;
  std::int32_t voxel = 0;
};
TouchScene make_touch_scene(const TouchShape& shape, const TouchLayout& layout, Random& random);

/// A pose at some station, or one step away from it, and the pair that it has or has not.
LatticePose station_pose(const std::vector<Station>& stations, Random& random, Known& known);

}  // namespace palpate::equivalence

#pragma once
#include <array>
#include <cstdint>
#include <string>
#include <vector>

#include "model/lattice/vector.h"
#include "model/mesh/mesh.h"

namespace palpate {

/// What became of a triangle on the lattice.
enum TriangleFlag : std::uint8_t {
  kTriangleCollapsed = 1,  ///< no area on the lattice; in no set, keeps its number
  kTriangleSheet = 2,      ///< of a part with winding 0 on both sides
  kTriangleTurned = 4,     ///< of a part that was inside out; vertices 1 and 2 are exchanged
  kTriangleThin = 8,       ///< of a thin piece: what lies in it says little, its own samples speak for it
  kTriangleRepeated = 16,  ///< another with the same three corners speaks for it in the pressure field
};

/// One neighbour across a shared edge (the same two lattice vertices): neighbour id · 2 + (1 if the edge is
/// smooth).
using EdgeNeighbour = std::uint32_t;

inline constexpr std::uint32_t kNoPatch = 0xFFFFFFFF;

/// Every second sample, every fourth …: the field leaves samples out of large contacts, level by level
/// (docs/EXACTNESS.md section 4).
inline constexpr int kSampleLevels = 6;  // of more a weight might not fit into 32 bits, Q24
/// Samples of a contact at the surfaces, and extra samples, which are few, thin out up to this level; the
/// tool's samples far inside a mock-up, where all are much alike, go on to kSampleLevels.
inline constexpr int kSurfaceLevels = 4;

/// A point of a triangle that stands for what the grid of samples misses (docs/EXACTNESS.md section 4).
struct ExtraSample {
  std::uint32_t triangle = 0;
  Int3 point{0};                 ///< within a step of the triangle's plane
  std::uint32_t weight_q30 = 0;  ///< of s², > 0
  std::array<std::uint32_t, kSurfaceLevels>
      coarse_q30{};  ///< of levels 1, 2, …, of 2^level s²: its own and those of others that it stands for
                     ///< there; 0: another stands for it
  bool operator==(const ExtraSample&) const = default;
};

/// By which factor the weights of a side's samples grow besides 2^level when the field takes only those of a
/// level.
struct SideLevels {
  std::uint32_t coarsest = 0;  ///< the last level that still sees the side fairly, at least 1
  std::array<std::uint32_t, kSampleLevels> factor_q30{};  ///< of levels 1 to `coarsest`
  bool operator==(const SideLevels&) const = default;
};

/// A body snapped to the lattice, welded and oriented; made once at load on the host and read by both back
/// ends.
struct LatticeMesh {
  std::vector<Int3> vertices;  ///< distinct points, |c| ≤ kLatticeReach
  std::vector<std::array<std::uint32_t, 3>>
      triangles;                                 ///< vertex indices, counter-clockwise seen from outside
  std::vector<std::uint8_t> flags;               ///< TriangleFlag bits, one a triangle
  std::vector<Int3> unit_normal_q30;             ///< outward n̂, Q30, rounded to nearest; 0 if collapsed
  std::vector<std::uint32_t> sample_weight_q30;  ///< 1/|n̂_axis| in [1, √3], Q30; 0 if collapsed
  std::vector<std::uint8_t> sample_axis;         ///< axis of the raw normal's largest component, ties: lowest
  std::vector<std::uint32_t> neighbour_begin;    ///< CSR, triangles.size() + 1
  std::vector<EdgeNeighbour> neighbours;         ///< ascending in each triangle, each neighbour once
                                                 ///< (smooth if any edge shared with it is smooth)
  std::vector<std::uint32_t> patch;  ///< about a CAD face, by triangle: joined over smooth edges, in one
                                     ///< part; numbered by their smallest triangle; kNoPatch if collapsed
  std::uint32_t patch_count = 0;
  std::vector<std::uint32_t>
      field_weight_q30;  ///< what the pressure field takes for sample_weight_q30: of small and thin
                         ///< faces scaled, so that s²·w adds up to their area; 0 if collapsed or repeated
  std::vector<ExtraSample>
      extra_samples;  ///< of faces that the grid misses; ascending by triangle, which may have several
  std::vector<std::uint32_t>
      levels_of;  ///< by triangle: 1 + its place in `side_levels`; 0: all its samples count always
  std::vector<SideLevels> side_levels;  ///< of large sides
  std::vector<std::uint32_t>
      grid_samples;             ///< of the tool, by triangle: how many weigh something (count_grid_samples())
  bool closed = false;          ///< edges, each with its direction, cancel point for point
  Int3 box_min{0}, box_max{0};  ///< of all triangles that did not collapse

  /// Corner k (0, 1, 2) of a triangle, lattice steps.
  Int3 corner(std::uint32_t triangle, int k) const {
    return vertices[triangles[triangle][static_cast<std::size_t>(k)]];
  }
  /// Whether snapping left the triangle no area; such a one meets nothing.
  bool collapsed(std::uint32_t triangle) const { return (flags[triangle] & kTriangleCollapsed) != 0; }
  /// Whether another triangle speaks for it in the pressure field; in sets it is like any other.
  bool repeated(std::uint32_t triangle) const { return (flags[triangle] & kTriangleRepeated) != 0; }
};

/// What import and snapping did to a body, for `info` and for the log.
struct MeshReport {
  /// A named part of the body.
  struct Part {
    std::string path;
    std::uint32_t triangles = 0;
    std::uint32_t collapsed = 0;  ///< of them, without an area on the lattice
    bool closed = false;
    bool sheet = false;
    bool turned = false;
    bool orientable = true;
    Vec3 box_min_m{0}, box_max_m{0};
  };
  std::vector<Part> parts;
  std::uint32_t triangles = 0, vertices = 0, collapsed = 0, duplicate = 0;
  std::uint32_t open_edges = 0, nonmanifold_edges = 0;
  double largest_gap_m = 0;        ///< longest boundary loop's bounding-box diagonal; 0 when closed
  std::vector<std::string> notes;  ///< sentences: what was dropped, turned round, found open
};

}  // namespace palpate

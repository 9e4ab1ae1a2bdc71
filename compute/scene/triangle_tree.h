#pragma once
#include <array>
#include <cstdint>
#include <functional>
#include <vector>

#include "model/lattice/lattice_mesh.h"

namespace palpate {

/// A bounding volume hierarchy over triangles of a body, to begin with those that bound a solid: runs of
/// eight triangles, eight runs, and so on, each with the boxes of its eight in its body's lattice frame; the
/// lowest levels have boxes that lie along their triangles, too. 18 bytes a triangle.
struct TriangleTree {
  static constexpr std::size_t kEight = 8;
  /// Lows and highs by axis, steps. The last Boxes of a level may hold fewer than eight; the rest says
  /// nothing.
  struct Boxes {
    std::array<std::array<std::int32_t, kEight>, 3> low, high;
  };

  /// Levels of which there are turned boxes: of 8, 64 and 512 triangles. Larger ones are mostly curved.
  static constexpr std::size_t kTurnedLevels = 3;
  /// The same boxes along axes of their own, of unit length and at right angles but for rounding. By axis,
  /// then by component; from the first corner of the first triangle in it on, steps.
  struct TurnedBoxes {
    std::array<std::array<std::int32_t, kEight>, 3> corner;
    std::array<std::array<std::array<float, kEight>, 3>, 3> axis;
    std::array<std::array<float, kEight>, 3> low,
        high;  ///< along the axes as they are rounded, rounded outwards
  };

  std::vector<std::uint32_t> order;  ///< triangles by place; run r is what stands from place 8 r on
  std::vector<Boxes> boxes;          ///< of runs first, then of eight of these, …; the last one is the root
  std::vector<std::uint32_t> level_begin;  ///< of each level in `boxes`
  std::vector<TurnedBoxes> turned;         ///< as the first of `boxes`: those of kTurnedLevels levels

  std::uint64_t bytes() const {
    return sizeof order[0] * std::uint64_t{order.size()} + sizeof(Boxes) * std::uint64_t{boxes.size()} +
           sizeof(TurnedBoxes) * std::uint64_t{turned.size()};
  }

  /// How many runs there are, for level 0; for others, how many Boxes of the level before.
  std::uint32_t nodes(std::uint32_t level) const {
    if (level == 0) return static_cast<std::uint32_t>((order.size() + kEight - 1) / kEight);
    return (level == level_begin.size() ? static_cast<std::uint32_t>(boxes.size()) : level_begin[level]) -
           level_begin[level - 1];
  }

  /// TriangleFlag bits of what bounds no solid.
  static constexpr std::uint8_t kNotSolid = kTriangleCollapsed | kTriangleSheet;

  /// On all cores; `go_on` is asked now and then on this thread. Cancelled: empty. `without`: TriangleFlag
  /// bits of what is left out. `turns`: false leaves `turned` empty.
  static TriangleTree make(const LatticeMesh& mesh, const std::function<bool()>& go_on,
                           std::uint8_t without = kNotSolid, bool turns = true);
};

}  // namespace palpate

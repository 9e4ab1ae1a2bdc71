#pragma once
#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "model/lattice/vector.h"

namespace palpate {

enum class PolygonKind {
  kConvex,    ///< split as a fan from its first corner
  kConcave,   ///< split by cutting ears off
  kCrossing,  ///< its sides cross each other, seen along its mean normal: it bounds no one area, and is split
              ///< as a fan
};

/// Splits a polygon of at least three corners into corners − 2 triangles of the same sense: its sides, and
/// those between, each used once in each direction, so that what was closed stays so. `out` is appended to:
/// numbers of corners. Corners need not be in one plane; they are looked at along their mean normal
/// (Newell's). Holes don't occur.
PolygonKind split_polygon(std::span<const Vec3> corners, std::vector<std::array<std::uint32_t, 3>>& out);

}  // namespace palpate

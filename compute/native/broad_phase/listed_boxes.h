#pragma once
#include <cstddef>
#include <cstdint>

namespace palpate {

/// A tool triangle from a voxel, for the boxes of what that voxel lists (SearchTables::boxes). Parts are
/// kVoxelParts-ths of the voxel's side.
struct ListLook {
  std::int32_t box[6];  ///< the triangle's own, low x, y, z, high x, y, z: parts from the voxel's low corner
                        ///< on, also beyond the voxel
  float facing[3];      ///< along its normal, half parts a part along each axis: their sizes add up to 2
  float
      plane;  ///< how far before its plane the middle of the part at the voxel's low corner lies, half parts
  float slack;  ///< half parts by which a box must be off the plane to be apart
};

/// Of boxes 0 … count − 1, count ≤ kMostBoxes, those that meet the triangle's box and its plane: a bit each.
/// Coordinate k of box i is at boxes[k · stride + i]; SearchTables::kBoxesAtOnce − 1 more of each row may be
/// read.
std::uint64_t near_boxes(const ListLook& look, const std::uint8_t* boxes, std::size_t stride,
                         std::size_t count);
inline constexpr std::size_t kMostBoxes = 64;

}  // namespace palpate

#pragma once
#include <cstdint>
#include <vector>

#include "bench/haptic/mesh.h"

namespace yardstick {

/// A body as voxels: 0 free, 1 with a triangle in it, 2 and more inside, one more for each voxel (of 26
/// neighbours) from the surface, at most 255.
class VoxelMap {
 public:
  /// `across`: voxels along the longest side.
  void build(const TriMesh& mesh, int across);

  /// What holds the point; 0 outside the map. `centre` becomes the voxel's where it isn't free.
  std::uint8_t at(const Vec3& point, Vec3& centre) const;
  double size() const { return size_; }  ///< of a voxel, m

 private:
  std::size_t index(int x, int y, int z) const {
    return (static_cast<std::size_t>(z) * static_cast<std::size_t>(count_[1]) + static_cast<std::size_t>(y)) *
               static_cast<std::size_t>(count_[0]) +
           static_cast<std::size_t>(x);
  }
  bool has(int x, int y, int z) const {
    return x >= 0 && y >= 0 && z >= 0 && x < count_[0] && y < count_[1] && z < count_[2];
  }
  void mark(const TriMesh& mesh);
  void flood();
  void layer();

  Vec3 origin_{0};
  double size_ = 0, inverse_ = 0;
  int count_[3] = {0, 0, 0};
  std::vector<std::uint8_t> cells_;
};

}  // namespace yardstick

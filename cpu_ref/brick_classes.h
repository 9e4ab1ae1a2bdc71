#pragma once
#include <array>
#include <cstdint>
#include <vector>

#include "model/lattice/voxel_grid.h"

namespace palpate::cpu_ref {

/// The class of every voxel of a grid, in two levels: one for a brick whose voxels were never told apart, 512
/// for others. Memory follows the surface. Not bounds-checked: voxels lie in the grid.
class BrickClasses {
 public:
  BrickClasses() = default;
  BrickClasses(const Int3& bricks, VoxelClass everywhere)
      : bricks_(bricks), states_(count(bricks), static_cast<std::uint32_t>(everywhere)) {}

  const Int3& bricks() const { return bricks_; }
  std::size_t brick_count() const { return states_.size(); }
  std::size_t brick_of(const Int3& voxel) const {
    const Int3 b = voxel / kBrickSide;
    return static_cast<std::size_t>(b.x + std::int64_t{bricks_.x} * (b.y + std::int64_t{bricks_.y} * b.z));
  }
  Int3 first_voxel(std::size_t brick) const {
    const auto x = static_cast<std::size_t>(bricks_.x), y = static_cast<std::size_t>(bricks_.y);
    return kBrickSide * Int3(static_cast<int>(brick % x), static_cast<int>(brick / x % y),
                             static_cast<int>(brick / x / y));
  }
  /// Whether one class stands for all of a brick.
  bool uniform(std::size_t brick) const { return states_[brick] < kFirstDetail; }
  VoxelClass at(const Int3& voxel) const {
    const std::uint32_t state = states_[brick_of(voxel)];
    return state < kFirstDetail ? static_cast<VoxelClass>(state)
                                : details_[state - kFirstDetail][place(voxel)];
  }
  /// The class of one voxel, or of its whole brick where that is uniform.
  void mark(const Int3& voxel, VoxelClass c) {
    std::uint32_t& state = states_[brick_of(voxel)];
    if (state < kFirstDetail)
      state = static_cast<std::uint32_t>(c);
    else
      details_[state - kFirstDetail][place(voxel)] = c;
  }
  /// The class of one voxel alone: its brick is told apart from now on.
  void set(const Int3& voxel, VoxelClass c) {
    std::uint32_t& state = states_[brick_of(voxel)];
    if (state < kFirstDetail) {
      details_.emplace_back().fill(static_cast<VoxelClass>(state));
      state = kFirstDetail + static_cast<std::uint32_t>(details_.size() - 1);
    }
    details_[state - kFirstDetail][place(voxel)] = c;
  }

  /// Marks with `to` all that is connected through faces with `start` and for which inside(class); inside(to)
  /// must be false. Calls visit(voxel, class, count) before, with count 512 and any voxel of it for a uniform
  /// brick, else 1.
  template <class Inside, class Visit>
  void flood(const Int3& start, VoxelClass to, const Inside& inside, const Visit& visit) {
    std::vector<Int3> open{start};
    const auto look_at = [&](const Int3& voxel) {
      if (inside(at(voxel))) open.push_back(voxel);
    };
    const Int3 size = bricks_ * kBrickSide;
    while (!open.empty()) {
      const Int3 voxel = open.back();
      open.pop_back();
      if (!inside(at(voxel))) continue;  // reached by another way meanwhile
      const bool whole = uniform(brick_of(voxel));
      visit(voxel, at(voxel), whole ? kBrickSide * kBrickSide * kBrickSide : 1);
      mark(voxel, to);
      for (int k = 0; k < 3; ++k)
        for (const int side : {-1, 1}) {
          Int3 next = voxel;
          if (!whole) {
            next[k] += side;
            if (next[k] >= 0 && next[k] < size[k]) look_at(next);
            continue;
          }
          // The brick beside it: the 64 voxels at the common face, or one of them if it is uniform too.
          next = voxel / kBrickSide * kBrickSide;
          next[k] += side < 0 ? -1 : kBrickSide;
          if (next[k] < 0 || next[k] >= size[k]) continue;
          const int face = uniform(brick_of(next)) ? 1 : kBrickSide;
          const int u = (k + 1) % 3, v = (k + 2) % 3;
          for (int i = 0; i < face; ++i)
            for (int j = 0; j < face; ++j) {
              Int3 at_face = next;
              at_face[u] += i;
              at_face[v] += j;
              look_at(at_face);
            }
        }
    }
  }

  std::uint64_t memory_bytes() const {
    return states_.capacity() * sizeof(std::uint32_t) + details_.capacity() * sizeof(Detail);
  }

 private:
  using Detail = std::array<VoxelClass, kBrickSide * kBrickSide * kBrickSide>;
  static constexpr std::uint32_t kFirstDetail = 256;  ///< smaller states are classes

  static std::size_t count(const Int3& bricks) {
    return static_cast<std::size_t>(bricks.x) * static_cast<std::size_t>(bricks.y) *
           static_cast<std::size_t>(bricks.z);
  }
  static std::size_t place(const Int3& voxel) {
    return static_cast<std::size_t>(
        voxel.x % kBrickSide + kBrickSide * (voxel.y % kBrickSide + kBrickSide * (voxel.z % kBrickSide)));
  }

  Int3 bricks_{0};
  std::vector<std::uint32_t> states_;  ///< a class, or kFirstDetail + place in details_
  std::vector<Detail> details_;
};

}  // namespace palpate::cpu_ref

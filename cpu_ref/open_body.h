#pragma once
#include <cstdint>
#include <unordered_map>

#include "cpu_ref/box_tree.h"
#include "cpu_ref/partition.h"
#include "model/lattice/lattice_mesh.h"

namespace palpate::cpu_ref {

/// A body that is not closed, in its own frame: which points lie inside it, and how far its voxels agree
/// (EXACTNESS section 4, "Vote" and "Doubt"). Remembers what it has worked out. One thread; the arguments
/// outlive it.
class OpenBody {
 public:
  /// `tree` holds the boxes of `mesh`'s triangles.
  OpenBody(const LatticeMesh& mesh, const BoxTree& tree, const Partition& partition)
      : mesh_(mesh), tree_(tree), partition_(partition) {}

  bool inside(const Int3& point);
  /// Whether anything can be: of a body that bounds nothing no point counts as inside (section 4,
  /// "Without inside").
  bool has_inside();
  /// What is left of the weight of a sample that lies inside.
  std::uint32_t sure(std::uint32_t weight, const Int3& point);
  std::uint64_t memory_bytes() const;

 private:
  VoxelClass kind_of(const Int3& voxel) const;
  int shells_at(const Int3& point);
  int shells(const Int3& voxel);
  int crossed(const Int3& from, const Int3& to) const;
  int way(Int3 from, const Int3& to);
  bool is_doubted(const Int3& voxel);
  bool says_less(const Int3& voxel, const Int3& than);

  const LatticeMesh& mesh_;
  const BoxTree& tree_;
  const Partition& partition_;
  std::unordered_map<std::uint64_t, int> shells_;  ///< by V_bnd voxel
  std::unordered_map<std::uint64_t, int> ways_;    ///< by voxel and axis: to the next one's middle
};

}  // namespace palpate::cpu_ref

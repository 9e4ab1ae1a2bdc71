#pragma once
#include <array>
#include <cstdint>
#include <functional>
#include <optional>
#include <vector>

#include "compute/scene/partition_lookup.h"

namespace palpate {

/// Of a body that is not closed: how many shells the middle of each V_bnd voxel is in, and which neighbours
/// see that otherwise (docs/EXACTNESS.md section 4, "Vote" and "Doubt"). Any number of threads.
class OpenShells {
 public:
  /// Σ of the signs of what the ways from a V_bnd voxel's middle to its faces cross: two an axis, up first.
  using Halves = std::array<std::int32_t, 6>;
  using Ask = std::function<Halves(const Int3& voxel, std::uint32_t boundary)>;

  using GoOn = std::function<bool()>;

  /// `ask` is called for every V_bnd voxel. On all cores; none: `go_on` said stop. Allocates.
  static std::optional<OpenShells> make(const PartitionView& view, const Ask& ask, const GoOn& go_on);

  int middle(std::uint32_t boundary) const { return middle_[boundary]; }
  void prefetch(std::uint32_t boundary) const { __builtin_prefetch(&middle_[boundary]); }
  /// Whether a body with a face bounds an inside: of one with none no middle is in a shell, and none in doubt
  /// (section 4, "Without inside").
  bool bounds_inside() const;
  /// All voxels see alike.
  bool agree() const { return doubts_.empty(); }
  /// Which of a voxel's 26 neighbours say less of it than itself: bit x + 3 y + 9 z of 27, 13 its own.
  std::uint32_t less(std::uint32_t boundary) const { return doubts_[boundary].less; }
  /// Of which it says less than they themselves.
  std::uint32_t more(std::uint32_t boundary) const { return doubts_[boundary].more; }
  /// What a cache keeps (model/cache/archive.h).
  template <class Archive, class Shells>
  static void archive(Archive& a, Shells& shells) {
    a(shells.middle_);
    a(shells.doubts_);
  }
  std::uint64_t bytes() const { return 4 * std::uint64_t{middle_.size()} + 8 * doubts_.size(); }

 private:
  struct Doubts {
    std::uint32_t less = 0, more = 0;
  };
  std::vector<std::int32_t> middle_;  ///< by V_bnd voxel
  std::vector<Doubts> doubts_;        ///< likewise; empty: they agree
};

}  // namespace palpate

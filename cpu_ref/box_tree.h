#pragma once
#include <cstdint>
#include <memory>
#include <utility>
#include <vector>

#include "cpu_ref/exact.h"

namespace palpate::cpu_ref {

/// A hierarchy of boxes that proposes candidates: what it leaves out is certainly no answer, what it finds
/// may not be one. Embree works in single precision inside; every box is grown by far more than that can
/// lose. One thread at a time.
class BoxTree {
 public:
  BoxTree();
  ~BoxTree();
  BoxTree(const BoxTree&) = delete;
  BoxTree& operator=(const BoxTree&) = delete;

  /// Replaces the boxes. Empty ones are never found. |coordinate| ≤ 2^29. Allocates.
  void build(std::vector<Box> boxes);

  /// Appends the numbers of boxes that the ray may pass, in no order. |direction|'s largest component is not
  /// 0.
  void along_ray(const Int3& origin, const Int3& direction, std::vector<std::uint32_t>& found) const;

  /// Appends, ascending, the numbers of boxes that meet `box`.
  void meeting(const Box& box, std::vector<std::uint32_t>& found) const;

  /// Appends all pairs (number in a, number in b) of boxes that meet, ascending.
  static void meeting_pairs(const BoxTree& a, const BoxTree& b,
                            std::vector<std::pair<std::uint32_t, std::uint32_t>>& found);

  std::uint64_t memory_bytes() const;

 private:
  struct Embree;
  std::unique_ptr<Embree> embree_;
};

}  // namespace palpate::cpu_ref

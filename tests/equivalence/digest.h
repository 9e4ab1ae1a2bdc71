#pragma once
#include <cstdint>
#include <string>

#include "model/contact/contacts.h"
#include "model/contact/response.h"
#include "model/lattice/voxel_grid.h"

namespace palpate::equivalence {

/// Folds 64-bit words into one; any change of any word changes it but for a chance of 2^-64.
class Digest {
 public:
  void add(std::uint64_t word) {
    state_ = (state_ ^ word) * 0x9E3779B97F4A7C15u;
    state_ ^= state_ >> 29;
  }
  std::uint64_t value() const { return state_; }

 private:
  std::uint64_t state_ = 0xCBF29CE484222325u;
};

/// What one case answered, folded. Apart, so that a difference says where to look.
struct CaseHashes {
  Digest preparation;  ///< grids, class of every voxel, list of every boundary voxel; mock-up and (`refined`)
                       ///< tool
  Digest sets;         ///< contact, truncation, count of pairs, CST … EST, frame flags
  Digest areas;        ///< areas, zones, flags
  Digest sums;         ///< directions, rays, heights, the field and what carries it
  Digest response;     ///< bits of d, n_c, cp, F and T, of areas and in sum, and of the law's planes
};

void add(CaseHashes& hashes, const VoxelPartition& partition);
void add(CaseHashes& hashes, const Contacts& contacts);
void add(CaseHashes& hashes, const ContactResponse& response);

}  // namespace palpate::equivalence

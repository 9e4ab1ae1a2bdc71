#pragma once
#include <functional>
#include <string>

#include "model/contact/contacts.h"
#include "model/lattice/voxel_grid.h"
#include "tests/equivalence/case.h"

namespace palpate::equivalence {

/// The first respect in which an answer is not what was known of it: "pairs: 3 known, 2 answered". Empty:
/// none.
std::string first_difference(const Known& known, const Contacts& contacts, const Pairs& pairs);

/// The first voxel whose class is not the known one. Empty: none.
std::string judge_classes(const VoxelPartition& partition,
                          const std::function<VoxelClass(const Int3& lower)>& known);

}  // namespace palpate::equivalence

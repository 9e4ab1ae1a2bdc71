#pragma once
#include <string>

#include "model/contact/contacts.h"
#include "model/lattice/voxel_grid.h"

namespace palpate {

/// The first field in which two answers differ, with both values: "areas[2].rays: 17, 18". Empty when all but
/// times are equal.
std::string first_difference(const Contacts& a, const Contacts& b);

/// The same for two partitions: "classes[1208]: 1, 2".
std::string first_difference(const VoxelPartition& a, const VoxelPartition& b);

}  // namespace palpate

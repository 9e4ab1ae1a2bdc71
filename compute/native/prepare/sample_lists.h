#pragma once
#include <cstdint>

#include "compute/scene/sample_points.h"

namespace palpate::native {

/// Every entry's samples (docs/EXACTNESS.md section 4), on all cores. kTooMany: more than `most_bytes`, or
/// than EntrySamples can number.
Listing list_samples(const LatticeMesh& mesh, const PartitionView& lists, std::int32_t spacing,
                     std::uint64_t most_bytes, const ListingProgress& go_on, EntrySamples& out);

}  // namespace palpate::native

#pragma once
#include <optional>
#include <vector>

#include "cpu_ref/frame.h"

namespace palpate::cpu_ref {

/// Needle: CST, a direction, and no sample that gave a height. Adds heights and the flag (EXACTNESS section 7).
void measure_needle(const Frame& frame, Area& area);

/// Which areas the measured rays of area `a` pierce. Fills `pierces`.
void find_pierced(const Frame& frame, std::vector<Area>& areas, std::size_t a);

/// Swallowed: IMT, and neither CST nor EST nor a counting sample. Fills direction, height and flags of the frame.
void measure_swallowed(const Frame& frame, Contacts& out);

}  // namespace palpate::cpu_ref

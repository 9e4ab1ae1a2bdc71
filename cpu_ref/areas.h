#pragma once
#include "cpu_ref/frame.h"

namespace palpate::cpu_ref {

/// The areas of C_s with their zones, mobile triangles, boxes and counting samples, ascending id (EXACTNESS section 5).
/// May return more than kMaxAreas.
std::vector<Area> find_areas(const Frame& frame, const Contacts& sets);

}  // namespace palpate::cpu_ref

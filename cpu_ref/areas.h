#pragma once
#include "cpu_ref/frame.h"

namespace palpate::cpu_ref {

/// `paper`: the areas of C_s with their zones, mobile triangles and boxes, ascending id (EXACTNESS section
/// 5). May return more than kMaxAreas.
std::vector<Area> find_areas(const Frame& frame);

}  // namespace palpate::cpu_ref

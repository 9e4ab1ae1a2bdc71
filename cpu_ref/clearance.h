#pragma once
#include "cpu_ref/frame.h"
#include "model/contact/clearance.h"

namespace palpate::cpu_ref {

/// The smallest distance of the tool's triangles at the pose to the mock-up's, of which none meets any
/// (EXACTNESS section 10). `frame`: as transform_tool() leaves it, its tree built. `collinear`: triangles of
/// the tool that are collinear at the pose, which are in no pair, count as segments.
Clearance smallest_distance(const Frame& frame, std::int32_t within, bool collinear);

}  // namespace palpate::cpu_ref

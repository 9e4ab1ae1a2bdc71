#pragma once
#include "cpu_ref/frame.h"

namespace palpate::cpu_ref {

/// `paper`: n_c of one area and its flags (EXACTNESS section 6).
void find_direction(const Frame& frame, Area& area);

/// Scales S ≠ 0 until its largest component lies in [2^28, 2^29).
Int3 normalise(const Long3& sum);

/// A tool triangle's n̂ turned into the world, Q30.
Int3 turned(const LatticePose& pose, const Int3& unit_normal_q30);

bool is_sheet(const LatticeMesh& mesh, std::uint32_t id);

}  // namespace palpate::cpu_ref

#pragma once
#include <cstdint>
#include <optional>

#include "cpu_ref/frame.h"

namespace palpate::cpu_ref {

/// `paper`: the smallest height H of any crossing of the ray from `origin` along `direction` = −D with the
/// area's own mobile triangles (EXACTNESS section 7).
std::optional<std::uint32_t> height(const Frame& frame, const Area& area, const Int3& origin,
                                    const Int3& direction);

/// `paper`: sends the rays of an area, if it has a direction.
void measure_heights(const Frame& frame, Area& area);

/// `paper`: sum and count of the centres of the area's V_bnd voxels that the tool touches.
void sum_voxels(const Frame& frame, Area& area);

}  // namespace palpate::cpu_ref

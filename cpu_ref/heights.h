#pragma once
#include <optional>
#include <vector>

#include "cpu_ref/frame.h"
#include "cpu_ref/ray.h"

namespace palpate::cpu_ref {

/// All crossings of the ray from `origin` along `direction` with the tool's triangles, in no order.
std::vector<Crossing> tool_crossings(const Frame& frame, const Int3& origin, const Int3& direction);

/// The height of the tool below a point along `direction` = −D (EXACTNESS section 7).
std::optional<std::uint32_t> height(const Frame& frame, const Int3& origin, const Int3& direction);

/// Adds one height to the sums of an area.
void add_height(Area& area, std::uint32_t height, std::uint32_t weight_q30, const Int3& sample);

/// Sends the rays of an area, if it has a direction.
void measure_heights(const Frame& frame, Area& area);

/// `paper`: sum and count of the centres of the area's V_bnd voxels that the tool touches.
void sum_voxels(const Frame& frame, Area& area);

}  // namespace palpate::cpu_ref

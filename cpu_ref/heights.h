#pragma once
#include <optional>
#include <vector>

#include "cpu_ref/frame.h"
#include "cpu_ref/ray.h"

namespace palpate::cpu_ref {

/// All crossings of the ray from `origin` along `direction` with the tool's triangles, in no order; `triangles`, if given, gets theirs.
std::vector<Crossing> tool_crossings(const Frame& frame, const Int3& origin, const Int3& direction, std::vector<std::uint32_t>* triangles = nullptr);

/// Where a ray leaves the tool.
struct Exit {
  std::uint32_t height = 0;   ///< H
  Int3 normal{0};             ///< m: of the tool's triangle there, as a direction
};

/// The height of the tool below a point along `direction` = −D (EXACTNESS section 7).
std::optional<Exit> height(const Frame& frame, const Int3& origin, const Int3& direction);

/// Adds one height to the sums of an area. `fade` H_0: below three times that height the weight is less, or more, than whole; under kLeastFade it is whole.
void add_height(Area& area, std::uint32_t height, std::uint32_t weight_q30, const Int3& sample, std::uint32_t fade);

/// Sends the rays of an area, if it has a direction.
void measure_heights(const Frame& frame, Area& area);

/// `paper`: sum and count of the centres of the area's V_bnd voxels that the tool touches.
void sum_voxels(const Frame& frame, Area& area);

}  // namespace palpate::cpu_ref

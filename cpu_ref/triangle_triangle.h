#pragma once
#include "cpu_ref/exact.h"

namespace palpate::cpu_ref {

/// Whether the closed segment pq and the closed triangle share a point. `triangle` is not collapsed; p = q is
/// allowed.
bool segment_meets_triangle(const Int3& p, const Int3& q, const Triangle& triangle);

/// Whether two closed triangles, neither collapsed, share a point.
bool triangles_intersect(const Triangle& s, const Triangle& t);

}  // namespace palpate::cpu_ref

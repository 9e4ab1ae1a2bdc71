#pragma once
#include "bench/haptic/mesh.h"

namespace yardstick {

/// Closed bodies, metres. Round ones are prisms and lathes of `sides`; a radius is that of the circle inside:
/// the flats, of which one has its normal along +x, lie at it.
TriMesh box(const Vec3& min, const Vec3& max);
/// About the origin; its lowest and highest vertex lie on the sphere.
TriMesh sphere(double radius, std::uint32_t sides);
/// About the z axis, its tip at the origin, opening upwards.
TriMesh cone(double radius, double height, std::uint32_t sides);
/// About the z axis, from −height/2 to height/2.
TriMesh cylinder(double radius, double height, std::uint32_t sides);
/// The same with a hole through it.
TriMesh ring(double inner, double outer, double height, std::uint32_t sides);

}  // namespace yardstick

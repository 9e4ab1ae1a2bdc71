#pragma once
#include <array>
#include <cstdint>
#include <vector>

#include "bench/haptic/vector.h"

namespace yardstick {

/// Triangles with their normals outwards, metres.
struct TriMesh {
  std::vector<Vec3> vertices;
  std::vector<std::array<std::uint32_t, 3>> triangles;
};

/// Of the enclosed volume, exact for a closed mesh.
Vec3 centre_of_volume(const TriMesh& mesh);
/// Radius of gyration of the surface about the origin: √(∫|x|² dA / ∫dA), m.
double gyration_radius(const TriMesh& mesh);
/// Of the vertex farthest from the origin, m.
double reach(const TriMesh& mesh);

void append(TriMesh& mesh, const TriMesh& other);
TriMesh shifted(TriMesh mesh, const Vec3& by);

}  // namespace yardstick

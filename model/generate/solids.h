#pragma once
#include <cstdint>
#include <string>
#include <utility>
#include <vector>

#include "model/lattice/pose.h"
#include "model/mesh/mesh.h"

/// Closed, outward oriented solids of a chosen tessellation, in metres, the same bytes on every machine. The
/// scene generators are made of them and so are most tests. Every function needs positive sizes and the least
/// counts stated; less is raised to them. Each returned mesh has one part without a name; a vertex may be
/// stored more than once, with equal bits.
namespace palpate::solids {

/// A closed polygon in space.
using Loop = std::vector<Vec3>;

enum class Ends {
  kJoined,  ///< the last loop is joined to the first: a closed ring
  kPoints,  ///< each end loop is closed by a fan round the mean of its points
};

/// Joins loops of equal size by strips of triangles. Outward means: each loop runs counter-clockwise seen
/// from where the loops go to. Triangles: 2·size·(loops − 1) + 2·size, both ways of closing.
Mesh loft(const std::vector<Loop>& loops, Ends ends);

/// Box from `min` to `max`, each axis cut into `cells` (≥ 1): 4·(xy + yz + zx) triangles, 12 by default.
Mesh box(const Vec3& min, const Vec3& max, const Int3& cells = Int3(1));

/// Sphere about the origin by latitude and longitude, poles on ±z: 2·segments·(rings − 1); segments ≥ 3,
/// rings ≥ 2.
Mesh sphere(double radius, std::uint32_t segments = 48, std::uint32_t rings = 24);

/// A sphere of about `triangles` (≥ 8) triangles.
Mesh sphere_of(double radius, std::uint64_t triangles);

/// Revolves a profile of (r, z) points about z, `segments` ≥ 3. A profile with the solid on its left, r to
/// the right and z up. kPoints: from the axis (bottom) to the axis (top), points with r > 0 alone are given;
/// kJoined: a closed profile.
Mesh revolve(const std::vector<std::pair<double, double>>& profile, std::uint32_t segments, Ends ends);

/// Cylinder along z from 0 to `height`, `rows` ≥ 1 along it, `cap_rings` ≥ 1 on each cap: 2·segments·(rows +
/// 2·cap_rings − 1).
Mesh cylinder(double radius, double height, std::uint32_t segments = 48, std::uint32_t rows = 1,
              std::uint32_t cap_rings = 1);

/// Cone about z, its tip at the origin, its base at `height`: 2·segments.
Mesh cone(double radius, double height, std::uint32_t segments = 48);

/// Ring of rectangular section about z, from z = 0 to `height`: 8·segments triangles at one row and one step.
Mesh ring(double inner_radius, double outer_radius, double height, std::uint32_t segments = 48,
          std::uint32_t rows = 1, std::uint32_t steps = 1);

/// Torus about z: 2·segments·sides.
Mesh torus(double ring_radius, double tube_radius, std::uint32_t segments = 48, std::uint32_t sides = 24);

/// Adds `part` behind `into` as a part named `name`.
void append(Mesh& into, const Mesh& part, const std::string& name);

/// Every vertex moved: rotation · v + position.
Mesh moved(Mesh mesh, const Pose& pose);

/// Every face (triangles joined over edges no sharper than 45°) with corners of its own, moved towards its
/// middle by a `share` of the way: faces that do not meet, as CAD programs write them. No longer closed.
Mesh split(const Mesh& mesh, double share);

/// The same shell inside out.
Mesh turned_inside_out(Mesh mesh);

/// Enclosed volume, m³; negative when inside out.
double volume(const Mesh& mesh);

/// Edges whose uses in the two directions are not equal in number, vertices being the same when bit-equal. 0:
/// closed.
std::uint64_t open_edges(const Mesh& mesh);

}  // namespace palpate::solids

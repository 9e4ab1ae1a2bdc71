#pragma once
#include <array>
#include <cstdint>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "model/lattice/lattice_mesh.h"
#include "model/lattice/voxel_grid.h"
#include "model/mesh/mesh.h"
#include "service/server/http/http_message.h"

namespace palpate {

/// A body of a scene, in metres. Refers to its mesh.
struct BodyView {
  const LatticeMesh& mesh;
  Vec3 origin_m{
      0};  ///< where the mesh's lattice origin lies: world frame for the mock-up, tool frame for the tool
  double step_m = 0;
  Vec3 point(std::size_t vertex) const { return origin_m + step_m * Vec3(mesh.vertices[vertex]); }
};

/// Triangles to draw; `ids[i]` is the number of triangle i in the mesh that it was taken from.
struct DrawnMesh {
  std::vector<Vec3> vertices;  ///< m, in the mesh's frame
  std::vector<std::array<std::uint32_t, 3>> triangles;
  std::vector<std::uint32_t> ids;
};

/// At most `most` triangles: vertices that share a cell of a grid become one of them, and what collapses or
/// repeats is left out. The grid is as fine as `most` allows, to a quarter.
DrawnMesh reduced(const BodyView& body, std::size_t most);
/// The same of a mesh as it was imported, in its own units.
DrawnMesh reduced(const Mesh& mesh, std::size_t most);

/// "1,5-9" → 1 5 6 7 8 9. Nothing: not such a list, an id from `count` on, or more than `most`.
std::optional<std::vector<std::uint32_t>> parse_ids(std::string_view text, std::size_t count,
                                                    std::size_t most);

/// `PVOX` of docs/SERVICE.md. Nothing: more than `most` voxels of the class, or the grid is too large for
/// their numbers. `origin_m`: of the lattice that the partition lives on.
std::optional<std::string> voxel_bytes(const VoxelPartition& partition, VoxelClass wanted, bool tool,
                                       const Vec3& origin_m, double step_m, std::uint32_t most);

}  // namespace palpate

#pragma once
#include <array>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "model/lattice/vector.h"

namespace palpate {

/// A run of consecutive triangles that came from one node of a file (or one generated solid).
struct MeshPart {
  std::string path;  ///< node names from the root, joined by '/'
  std::uint32_t first_triangle = 0;
  std::uint32_t triangle_count = 0;
  std::string also = {};  ///< another name that the file has for it (glTF: its mesh; CAD: this place in the
                          ///< assembly); empty: none
  std::optional<std::uint32_t> colour =
      {};  ///< 0xrrggbb, sRGB, where the file states one and its reader tells it (CAD, glTF)
};

/// Triangles as imported or generated: metres, in the frame of the file (node transforms applied).
/// Triangle i keeps the number i for ever (ARCHITECTURE: parts in scene order, nodes depth-first, faces in
/// order).
struct Mesh {
  std::vector<Vec3> vertices;                           ///< m; not necessarily welded
  std::vector<std::array<std::uint32_t, 3>> triangles;  ///< indices into vertices
  std::vector<MeshPart> parts;                          ///< in triangle order, covering all triangles
};

}  // namespace palpate

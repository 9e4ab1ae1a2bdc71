#pragma once
#include <string>

#include "bench/haptic/mesh.h"

namespace yardstick {

/// A binary little-endian PLY whose vertices are `float x, y, z` and whose faces are triangles, `uchar int`.
/// Throws std::runtime_error with a sentence.
TriMesh read_ply(const std::string& file);

}  // namespace yardstick

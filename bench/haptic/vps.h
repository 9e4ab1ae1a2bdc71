#pragma once
#include "bench/haptic/penalty.h"

namespace yardstick {

/// Voxmap PointShell after McNeely, Puterbaugh and Troy, "Six degree-of-freedom haptic rendering using voxel
/// sampling" (SIGGRAPH 1999), plain. The mock-up is a map of voxels, 512 along its longest side: free,
/// surface (a triangle passes through it), or inside with the number of voxels to the surface. The tool is a
/// shell of 100,000 points, evenly over its surface, with inward normals. A point in a surface voxel is
/// pushed along its normal until it has passed the plane through the voxel's centre; inside, by as many
/// voxels more as lie between. Each point has K; with more than ten in touch, the sum is divided by a tenth
/// of their number.
std::unique_ptr<Adapter> make_vps();

}  // namespace yardstick

#pragma once
#include <string>

#include "bench/haptic/case.h"

namespace yardstick {

/// A real part on its way out of an assembly. `files`: NAME=FIXED.ply,TOOL.ply,POSES.csv; meshes in metres,
/// binary little-endian PLY of triangles; poses x,y,z,qx,qy,qz,qw below a line of heads, world from the
/// tool's file. No truth is known: steps, noise, work round a loop, time and memory are judged. Throws
/// std::runtime_error with a sentence.
Case part(const std::string& files, const Amount& amount);

}  // namespace yardstick

#pragma once
#include <cstdint>
#include <string>
#include <vector>

#include "model/lattice/pose.h"
#include "model/scene/scene_geometry.h"

namespace palpate {

/// An image of four bytes a pixel, red, green, blue, opacity, row by row from the top.
struct Image {
  std::uint32_t width = 0, height = 0;
  std::vector<std::uint8_t> pixels;
};

/// The scene with the tool at each pose, all from one side, as near as shows every place of the tool and a
/// third of its size around: mock-up grey, tool blue, and pale where the mock-up hides it. The ground is
/// transparent. One image a pose; a pose that can't be rounded to the lattice has an empty one.
std::vector<Image> scene_pictures(const SceneGeometry& geometry, const std::vector<Pose>& poses);

/// "data:image/png;base64,…"; empty for an empty image.
std::string png_address(const Image& image);

}  // namespace palpate

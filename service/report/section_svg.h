#pragma once
#include <string>

#include "model/lattice/lattice.h"
#include "model/scene/scene_geometry.h"

namespace palpate {

/// What a section shows. World, m.
struct SectionView {
  Vec3 middle{0};                    ///< in the plane, in the picture's middle
  Vec3 right{1, 0, 0}, up{0, 0, 1};  ///< unit, across each other: they span the plane
  double width_m = 0.1;              ///< of the picture
  bool gap = false;                  ///< draws the line from `on_static` to `on_mobile`
  Vec3 on_static{0}, on_mobile{0};
  std::string label;  ///< beside the gap, or the middle
};

/// A view whose plane holds both points and is level where that is possible. `apart`: the way from one to the
/// other, 0: any.
SectionView section_through(const Vec3& middle, const Vec3& apart, double width_m);

/// Both bodies at a pose, cut by the plane: the mock-up's outline and the tool's, a scale bar, the gap. An
/// SVG picture by itself that follows the page's colours.
std::string section_svg(const SceneGeometry& geometry, const LatticePose& pose, const SectionView& view);

}  // namespace palpate

#pragma once
#include <string>

#include "model/lattice/lattice.h"
#include "model/scene/scene_geometry.h"

namespace palpate {

/// What a section shows. World, m.
struct SectionView {
  Vec3 middle{0};                    ///< in the plane, in the picture's middle
  Vec3 mark{0};                      ///< in the plane: what the picture is about, in a circle
  Vec3 right{1, 0, 0}, up{0, 0, 1};  ///< unit, across each other: they span the plane
  double width_m = 0.1;              ///< of the picture
  bool gap = false;                  ///< draws the line from `on_static` to `on_mobile`
  Vec3 on_static{0}, on_mobile{0};
  std::string label;  ///< beside the mark
};

/// Where a lattice point of the world is, m.
Vec3 in_world(const SceneGeometry& geometry, const Int3& p);

/// A view about a point whose plane holds the way between two others and is upright where that is possible.
/// `apart`: that way, 0: any.
SectionView section_through(const Vec3& middle, const Vec3& apart, double width_m);

/// Turns the plane about `apart`, by as little as need be, until it cuts as much of the tool as is near:
/// an edge or a corner that is nearest an upright plane may just graze.
void turn_through_tool(const SceneGeometry& geometry, const LatticePose& pose, const Vec3& apart,
                       SectionView& view);

/// Shows the whole tool in that plane, and the mark.
void show_tool(const SceneGeometry& geometry, const LatticePose& pose, SectionView& view);

/// Both bodies at a pose, cut by the plane: the mock-up's outline and the tool's, a scale bar, the gap. An
/// SVG picture by itself that follows the page's colours.
std::string section_svg(const SceneGeometry& geometry, const LatticePose& pose, const SectionView& view);

}  // namespace palpate

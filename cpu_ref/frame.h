#pragma once
#include <cstdint>
#include <utility>
#include <vector>

#include "cpu_ref/box_tree.h"
#include "cpu_ref/open_body.h"
#include "cpu_ref/partition.h"
#include "model/contact/contacts.h"
#include "model/scene/plan.h"
#include "model/scene/scene_geometry.h"

namespace palpate::cpu_ref {

/// What prepare() leaves behind for every query. The geometry belongs to the caller.
struct Prepared {
  const SceneGeometry* geometry = nullptr;
  Profile profile = Profile::kRefined;
  Partition mockup;
  Partition tool;                 ///< `refined` only
  bool mockup_has_inside = true;  ///< closed, or OpenBody::has_inside(); `refined`
  bool tool_has_inside = true;    ///< closed, or OpenBody::has_inside()
  BoxTree mockup_tree;            ///< boxes of the mock-up's triangles
  BoxTree tool_rest_tree;         ///< `refined`: boxes of the tool's triangles in its own frame

  bool refined() const { return profile == Profile::kRefined; }
  /// No inside was found: its samples push as a sheet's do (EXACTNESS section 8).
  bool tool_open() const { return refined() && !tool_has_inside; }
};

/// A sample of a static triangle, world lattice.
struct Sample {
  std::uint32_t triangle = 0;
  Int3 point{0};
};

/// One pose and what has been found of it so far. World lattice throughout. All lists ascending.
struct Frame {
  const Prepared& scene;
  const LatticePose& pose;
  const Ignored* ignored;             ///< may be null
  const BoxTree& tool_tree;           ///< boxes of `tool`
  OpenBody &open_mockup, &open_tool;  ///< what is asked of a body that is not closed

  std::vector<Int3> vertices;  ///< of the tool, transformed
  std::vector<Triangle> tool;  ///< of the tool, transformed; collapsed: in nothing at this pose
  Box tool_box;                ///< of those that did not collapse

  std::vector<std::pair<std::uint32_t, std::uint32_t>> pairs;  ///< static, mobile
  std::vector<std::uint64_t> touched_boundary,
      touched_internal;          ///< V_bnd and V_int voxels a mobile triangle touches
  std::vector<Sample> counting;  ///< `refined`: samples inside the tool, by triangle
  std::vector<std::uint32_t> contact_static, contact_mobile;  ///< C_s, C_m

  const LatticeMesh& mockup() const { return scene.geometry->mockup; }
  const LatticeMesh& tool_mesh() const { return scene.geometry->tool; }
};

/// One area of `paper` on its way to `out`.
struct Area {
  ContactArea out;
  Box box;  ///< of its triangles' corners

  Int3 doubled_centre() const { return box.min + box.max; }
};

}  // namespace palpate::cpu_ref

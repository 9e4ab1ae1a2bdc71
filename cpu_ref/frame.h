#pragma once
#include <cstdint>
#include <utility>
#include <vector>

#include "cpu_ref/box_tree.h"
#include "cpu_ref/partition.h"
#include "model/contacts.h"
#include "model/plan.h"
#include "model/scene_geometry.h"

namespace palpate::cpu_ref {

/// What prepare() leaves behind for every query. The geometry belongs to the caller.
struct Prepared {
  const SceneGeometry* geometry = nullptr;
  Profile profile = Profile::kRefined;
  Partition mockup;
  Partition tool;                 ///< `refined` only
  bool tool_has_inside = true;    ///< closed, or its partition has a V_int voxel
  BoxTree mockup_tree;            ///< boxes of the mock-up's triangles

  bool refined() const { return profile == Profile::kRefined; }
  /// Heights of a tool without inside are the nearest hits (EXACTNESS section 4).
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
  const Held* held;                               ///< may be null
  const BoxTree& tool_tree;                       ///< boxes of `tool`

  std::vector<Int3> vertices;                     ///< of the tool, transformed
  std::vector<Triangle> tool;                     ///< of the tool, transformed; collapsed: in nothing at this pose
  Box tool_box;                                   ///< of those that did not collapse

  std::vector<std::pair<std::uint32_t, std::uint32_t>> pairs;   ///< static, mobile
  std::vector<std::uint64_t> touched_boundary, touched_internal;   ///< V_bnd and V_int voxels a mobile triangle touches
  std::vector<Sample> counting;                   ///< `refined`: counting samples, by triangle
  std::vector<std::uint32_t> contact_static, contact_mobile;       ///< C_s, C_m

  const LatticeMesh& mockup() const { return scene.geometry->mockup; }
  const LatticeMesh& tool_mesh() const { return scene.geometry->tool; }
};

/// A ray from a surface point along −D and the height it found.
struct MeasuredRay {
  Int3 from{0};
  std::uint32_t height = 0;
};

/// One area on its way to `out`.
struct Area {
  ContactArea out;
  Box box;                                        ///< of its triangles' corners
  std::vector<std::uint32_t> cst;                 ///< its CST, ascending
  std::vector<Sample> counting;                   ///< `refined`
  std::vector<MeasuredRay> rays;                  ///< of its counting samples, or of its needle samples on pairs

  Int3 doubled_centre() const { return box.min + box.max; }
  /// Neither a crossing nor a sample inside: it gives nothing (`refined`).
  bool proximity() const { return cst.empty() && counting.empty(); }
};

}  // namespace palpate::cpu_ref

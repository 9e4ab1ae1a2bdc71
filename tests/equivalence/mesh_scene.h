#pragma once
#include <functional>

#include "model/mesh/mesh.h"
#include "model/scene/geometry_build.h"
#include "tests/equivalence/case.h"

namespace palpate::equivalence {

/// A scene of two meshes in metres, as a scene file would give them.
inline Result<TestScene> mesh_scene(const Mesh& mockup, const Mesh& tool, const GeometrySettings& settings,
                                    std::function<LatticePose(const SceneGeometry&, Random&, Known&)> pose) {
  auto geometry = build_geometry(mockup, tool, settings);
  if (!geometry) return geometry.error();
  TestScene scene;
  scene.geometry = std::move(*geometry);
  scene.pose = std::move(pose);
  return scene;
}

}  // namespace palpate::equivalence

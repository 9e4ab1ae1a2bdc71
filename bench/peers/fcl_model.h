#pragma once
#include <fcl/geometry/bvh/BVH_model.h>

#include <cstdint>
#include <utility>
#include <vector>

#include "bench/peers/bodies.h"

namespace palpate::peers {

/// FCL's hierarchy of boxes of one kind over a mesh; returns the triangles' ids by FCL's numbers.
template <class Box>
std::vector<std::uint32_t> load(const LatticeMesh& mesh, double step_m, fcl::BVHModel<Box>& model) {
  Body body = body_of(mesh);
  std::vector<fcl::Vector3d> points;
  points.reserve(mesh.vertices.size());
  for (const Int3& v : mesh.vertices) points.emplace_back(step_m * v.x, step_m * v.y, step_m * v.z);
  std::vector<fcl::Triangle> triangles;
  triangles.reserve(body.triangles.size());
  for (const auto& [a, b, c] : body.triangles) triangles.emplace_back(a, b, c);
  model.beginModel(static_cast<int>(triangles.size()), static_cast<int>(points.size()));
  model.addSubModel(points, triangles);
  model.endModel();
  return std::move(body.ids);
}

inline fcl::Transform3d world_from_tool(const LatticePose& pose, double step_m) {
  const RigidMotion motion = rigid_motion(pose, step_m);
  fcl::Transform3d out = fcl::Transform3d::Identity();
  for (int i = 0; i < 3; ++i) {
    for (int j = 0; j < 3; ++j)
      out.linear()(i, j) = motion.rotation[static_cast<std::size_t>(i)][static_cast<std::size_t>(j)];
    out.translation()(i) = motion.translation_m[i];
  }
  return out;
}

}  // namespace palpate::peers

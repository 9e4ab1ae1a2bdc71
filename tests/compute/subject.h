#pragma once
#include <gtest/gtest.h>

#include <cstddef>
#include <cstdint>
#include <utility>
#include <vector>

#include "model/files/path_file.h"
#include "model/generate.h"
#include "model/scene/geometry_build.h"

namespace palpate {

struct Subject {
  SceneGeometry geometry;
  std::vector<LatticePose> poses;
};

/// A scene of the chapter and poses along its path.
inline Subject subject(const char* name, std::uint64_t triangles, std::size_t count) {
  Subject out;
  const auto scene = generate_scene(name, triangles, 1000);
  EXPECT_TRUE(scene);
  auto geometry = build_geometry(scene->mockup, scene->tool, {});
  EXPECT_TRUE(geometry);
  out.geometry = std::move(*geometry);
  for (std::size_t i = 0; i < count; ++i)
    out.poses.push_back(
        *to_lattice(path_pose(scene->path[i * scene->path.size() / count], scene->guide), out.geometry));
  return out;
}

/// What was made; the test fails where nothing was.
template <class T>
T taken(Result<T>&& made) {
  EXPECT_TRUE(made) << made.error().sentence;
  return std::move(*made);
}

}  // namespace palpate

#include "compute/native/narrow_phase/open_shells.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cstdint>
#include <initializer_list>
#include <memory>
#include <random>
#include <string>
#include <utility>
#include <vector>

#include "compute/native/narrow_phase/inside_search.h"
#include "compute/native/prepare/partition_build.h"
#include "compute/scene/search_tables.h"
#include "cpu_ref/open_body.h"
#include "tests/cpu_ref/lattice_scene.h"

namespace palpate {
namespace {

constexpr std::int32_t kSize = 1 << 14;  // of a voxel, steps
constexpr std::uint32_t kWhole = 0xFFFFFFFF;

/// A body that is not closed, as both engines know it.
struct Body {
  explicit Body(const std::vector<cpu_ref::Triangle>& triangles)
      : mesh(cpu_ref::lattice_mesh_of(triangles)),
        grid(make_grid(mesh.box_min, mesh.box_max, kSize)),
        made(native::make_partition(mesh, grid, 3, "body", [] { return true; }).value()),
        view(made),
        partition(view),
        boxes(SearchTables::boxes_of(mesh, view)),
        search(mesh, partition, boxes),
        known(OpenInside::make(mesh, view, boxes,
                               OpenInside::count_shells(mesh, view, boxes, [] { return true; }))),
        ref_partition(cpu_ref::make_partition(mesh, grid, 3, {}).value()),
        ref(mesh, tree, ref_partition) {
    search.use(known);
    std::vector<cpu_ref::Box> all;
    for (std::uint32_t t = 0; t < mesh.triangles.size(); ++t)
      all.push_back(mesh.collapsed(t) ? cpu_ref::Box() : cpu_ref::triangle_of(mesh, t).box());
    tree.build(std::move(all));
  }

  LatticeMesh mesh;
  VoxelGrid grid;
  Partition made;
  PartitionView view;
  PartitionLookup partition;
  std::vector<std::uint8_t> boxes;
  InsideSearch search;
  std::shared_ptr<const OpenInside> known;
  cpu_ref::BoxTree tree;
  cpu_ref::Partition ref_partition;
  cpu_ref::OpenBody ref;
};

/// A pin of two by two voxels, 20 long, that lacks its upper end face: eight voxels from that end its voxels
/// stop being inside, and what its samples weigh has ramped down to nothing there.
TEST(OpenShells, APinsWeightsRampDownWhereItsInsideEnds) {
  const Int3 low(kSize / 4);
  auto triangles =
      cpu_ref::lattice_box(low, Int3(2 * kSize - kSize / 4, 2 * kSize - kSize / 4, 20 * kSize + kSize / 4));
  triangles.resize(triangles.size() - 2);
  Body pin(triangles);
  ASSERT_FALSE(pin.mesh.closed);
  ASSERT_FALSE(pin.known->shells->agree());
  // Walks up from voxel 13 end beyond voxel 20, eight voxels on.
  constexpr std::int32_t kEnd = 13 * kSize;
  for (const std::int32_t below : {1, 2, 77, kSize / 4, kSize / 2 - 1, kSize / 2, kSize - 1, 3 * kSize}) {
    const Int3 point(kSize - 5, kSize + 9, kEnd - below);
    EXPECT_TRUE(pin.search.inside(point)) << below;
    const std::uint64_t part = static_cast<std::uint64_t>(std::min(2 * below, kSize));
    EXPECT_EQ(pin.search.sure(kWhole, point), kWhole * part / kSize) << below;
    EXPECT_EQ(pin.ref.sure(kWhole, point), kWhole * part / kSize) << below;
  }
  EXPECT_FALSE(pin.search.inside(Int3(kSize - 5, kSize + 9, kEnd)));
}

/// Whole but for a slit of a tenth of a voxel: nobody doubts it.
TEST(OpenShells, AgreeWhereAHoleIsNarrow) {
  auto triangles = cpu_ref::lattice_box(Int3(0), Int3(30 * kSize));
  const Int3 a(30 * kSize, 9 * kSize + 100, 9 * kSize), along(0, 0, 3 * kSize), across(0, kSize / 10, 0);
  const Int3 c(30 * kSize, 30 * kSize, 30 * kSize), o(30 * kSize, 0, 0);
  // The face at the end of x anew, round the slit from a to a + along.
  std::erase_if(triangles, [](const cpu_ref::Triangle& t) {
    return t[0].x == 30 * kSize && t[1].x == 30 * kSize && t[2].x == 30 * kSize;
  });
  const Int3 y(30 * kSize, 30 * kSize, 0), z(30 * kSize, 0, 30 * kSize);
  const Int3 b = a + across, d = a + along, e = a + across + along;
  for (const auto& [p, q, r] : std::initializer_list<std::array<Int3, 3>>{
           {o, y, a}, {y, b, a}, {y, c, b}, {c, e, b}, {c, z, e}, {z, d, e}, {z, o, d}, {o, a, d}})
    triangles.emplace_back(p, q, r);
  const Body body(triangles);
  ASSERT_FALSE(body.mesh.closed);
  EXPECT_TRUE(body.known->shells->agree());
}

struct Case {
  std::string name;
  std::vector<cpu_ref::Triangle> triangles;
};

std::vector<Case> open_bodies() {
  const auto without = [](const std::vector<cpu_ref::Triangle>& whole, std::size_t step) {
    std::vector<cpu_ref::Triangle> out;
    for (std::size_t i = 0; i < whole.size(); ++i)
      if (i % step != 1) out.push_back(whole[i]);
    return out;
  };
  const auto ball = cpu_ref::lattice_sphere(200'000, 24, 16),
             small = cpu_ref::lattice_sphere(150'000, 24, 16);
  auto crossing = without(ball, 61);  // and a ball beside it, with as many holes: two shells where both are
  for (const cpu_ref::Triangle& t : without(small, 7)) {
    const Int3 by(90'000, 20'000, 0);
    crossing.emplace_back(t[0] + by, t[1] + by, t[2] + by);
  }
  return {{"ball without a few", without(ball, 97)},
          {"ball without more", without(ball, 61)},
          {"balls through each other", crossing}};
}

TEST(OpenShells, WhatIsSureTheReferenceSaysToo) {
  int in_two_shells = 0;
  for (const Case& c : open_bodies()) {
    SCOPED_TRACE(c.name);
    Body body(c.triangles);
    ASSERT_FALSE(body.mesh.closed);
    std::mt19937 random(11);
    const auto within = [&](std::int32_t low, std::int32_t high) {
      return std::uniform_int_distribution<std::int32_t>(low, high)(random);
    };
    int inside = 0, doubted = 0, internal = 0, deep = 0;
    for (int i = 0; i < 60'000; ++i) {
      Int3 point;
      for (int k = 0; k < 3; ++k) point[k] = within(body.mesh.box_min[k], body.mesh.box_max[k]);
      if (i % 2 == 0) {  // in a V_bnd voxel or one beside it
        const Int3 voxel = body.view.boundary_voxel(static_cast<std::uint32_t>(
            within(0, static_cast<std::int32_t>(body.made.grid.boundary_voxels) - 1)));
        const Int3 low = body.made.grid.origin + kSize * voxel;
        for (int k = 0; k < 3; ++k) point[k] = within(low[k] - kSize / 2, low[k] + kSize * 3 / 2);
      }
      const Int3 voxel = body.partition.voxel_of(point);
      const PartitionLookup::Voxel at = body.partition.at(voxel);
      const bool is_inside = body.search.inside(point);
      ASSERT_EQ(is_inside, body.ref.inside(point)) << point.x << " " << point.y << " " << point.z;
      if (!is_inside) continue;
      ++inside;
      const std::uint32_t sure = body.search.sure(kWhole, point);
      ASSERT_EQ(sure, body.ref.sure(kWhole, point)) << point.x << " " << point.y << " " << point.z;
      doubted += sure < kWhole ? 1 : 0;
      internal += sure < kWhole && at.boundary == gpu::kNoVoxel ? 1 : 0;
      deep += at.boundary != gpu::kNoVoxel && body.known->shells->less(at.boundary) != 0 &&
                      body.search.shells_at(point, voxel, at.boundary) > 1
                  ? 1
                  : 0;
    }
    EXPECT_GT(inside, 1000);
    EXPECT_GT(doubted, 100);
    EXPECT_GT(internal, 10);
    in_two_shells += deep;
  }
  EXPECT_GT(in_two_shells, 0);  // where a neighbour that says less still says inside
}

}  // namespace
}  // namespace palpate

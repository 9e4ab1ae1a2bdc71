#include "compute/native/narrow_phase/inside_cells.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <memory>
#include <random>
#include <string>
#include <vector>

#include "compute/native/narrow_phase/inside_search.h"
#include "compute/native/narrow_phase/middle_crossings.h"
#include "compute/native/prepare/partition_build.h"
#include "compute/scene/exact.h"
#include "compute/scene/search_tables.h"
#include "compute/scene/tool_solid.h"
#include "tests/cpu_ref/lattice_scene.h"

namespace palpate {
namespace {

constexpr std::int32_t kVoxel = 1 << 14;  // steps

struct Case {
  std::string name;
  std::vector<cpu_ref::Triangle> triangles;
};

/// Without every `step`-th triangle.
std::vector<cpu_ref::Triangle> holed(const std::vector<cpu_ref::Triangle>& whole, std::size_t step) {
  std::vector<cpu_ref::Triangle> out;
  for (std::size_t i = 0; i < whole.size(); ++i)
    if (i % step != 1) out.push_back(whole[i]);
  return out;
}

std::vector<Case> cases() {
  const auto box = cpu_ref::lattice_box(Int3(-100'000, -60'001, -3'000), Int3(90'000, 70'000, 3'001));
  const auto ball = cpu_ref::lattice_sphere(200'000, 24, 16), small = cpu_ref::lattice_sphere(20'000, 24, 16);
  std::vector<Case> out;
  out.push_back({"box without a triangle", holed(box, 12)});
  out.push_back({"ball without a few", holed(ball, 97)});
  out.push_back({"ball without many", holed(ball, 5)});
  out.push_back({"many triangles a voxel", holed(small, 61)});
  auto nested = holed(ball, 61);
  nested.insert(nested.end(), small.begin(), small.end());
  nested.insert(nested.end(), box.begin(), box.end());
  out.push_back({"one through another, a third in it", nested});
  return out;
}

TEST(InsideCells, SayWhatCrossingsSayWhereTheySayAnything) {
  for (const Case& c : cases()) {
    SCOPED_TRACE(c.name);
    const LatticeMesh mesh = cpu_ref::lattice_mesh_of(c.triangles);
    ASSERT_FALSE(mesh.closed);
    const auto made = native::make_partition(mesh, make_grid(mesh.box_min, mesh.box_max, kVoxel), 3, "body",
                                             [] { return true; });
    ASSERT_TRUE(made);
    const PartitionView view(*made);
    const PartitionLookup partition(view);
    const std::vector<std::uint8_t> boxes = SearchTables::boxes_of(mesh, view);
    InsideSearch plain(mesh, partition, boxes);
    const auto shells = std::make_shared<OpenInside>();
    shells->shells = OpenInside::count_shells(mesh, view, boxes, [] { return true; });
    plain.use(shells);
    int asked = 0, known = 0, inside = 0;
    const InsideCells cells(mesh, view, boxes, [&](const Int3& point, const Int3&, std::uint32_t) {
      return plain.inside(point);
    });
    std::mt19937 random(5);
    const auto within = [&](std::int32_t low, std::int32_t high) {
      return std::uniform_int_distribution<std::int32_t>(low, high)(random);
    };
    for (int i = 0; i < 200'000; ++i) {
      // Anywhere in a voxel; on and beside a triangle; on and beside the borders of cells.
      const Int3 voxel = view.boundary_voxel(
          static_cast<std::uint32_t>(within(0, static_cast<std::int32_t>(made->grid.boundary_voxels) - 1)));
      const Int3 low = made->grid.origin + kVoxel * voxel;
      const auto id =
          static_cast<std::uint32_t>(within(0, static_cast<std::int32_t>(mesh.triangles.size()) - 1));
      Int3 point;
      for (int k = 0; k < 3; ++k)
        point[k] = i % 3 == 0   ? within(low[k], low[k] + kVoxel - 1)
                   : i % 3 == 1 ? low[k] + kVoxel / 8 * within(0, 8) + within(-2, 2)
                                : 0;
      if (i % 3 == 2) {
        const Int3 a = mesh.corner(id, 0), b = mesh.corner(id, 1), d = mesh.corner(id, 2);
        point = a + (b - a) / 16 * within(0, 8) + (d - a) / 16 * within(0, 8) +
                Int3(within(-5, 5), within(-5, 5), within(-5, 5));
      }
      const Int3 at = partition.voxel_of(point);
      const std::uint32_t boundary = partition.at(at).boundary;
      if (boundary == gpu::kNoVoxel) continue;
      ++asked;
      const std::optional<bool> answer = cells.find(point, at, boundary);
      if (!answer) continue;
      ++known;
      inside += *answer ? 1 : 0;
      ASSERT_EQ(*answer, plain.inside(point)) << point.x << " " << point.y << " " << point.z;
    }
    EXPECT_GT(known, asked / 20) << "of " << asked;
    EXPECT_GT(inside, 0);
    EXPECT_LT(inside, known);
  }
}

/// What is beside a sum that is not exact is asked of the integers: it is never wrong, and seldom unsure.
TEST(MiddleCrossings, AreWhatIntegersCount) {
  for (const Case& c : cases()) {
    SCOPED_TRACE(c.name);
    const LatticeMesh mesh = cpu_ref::lattice_mesh_of(c.triangles);
    const auto made = native::make_partition(mesh, make_grid(mesh.box_min, mesh.box_max, kVoxel), 3, "body",
                                             [] { return true; });
    ASSERT_TRUE(made);
    const PartitionView view(*made);
    const PartitionLookup partition(view);
    const MiddleCrossings crossings(mesh, view);
    ASSERT_FALSE(crossings.empty());
    std::mt19937 random(8);
    const auto within = [&](std::int32_t low, std::int32_t high) {
      return std::uniform_int_distribution<std::int32_t>(low, high)(random);
    };
    int unsure = 0, crossed = 0, asked = 0;
    for (int i = 0; i < 100'000; ++i) {
      const auto boundary =
          static_cast<std::uint32_t>(within(0, static_cast<std::int32_t>(made->grid.boundary_voxels) - 1));
      const Int3 low = made->grid.origin + kVoxel * view.boundary_voxel(boundary),
                 middle = low + Int3(kVoxel / 2);
      Int3 point;
      for (int k = 0; k < 3; ++k) point[k] = within(low[k], low[k] + kVoxel - 1);
      if (i % 3 == 0) {  // on a triangle, or a step beside it
        const auto list = partition.list(boundary);
        const std::uint32_t id = list[random() % list.size()];
        const Int3 a = mesh.corner(id, 0);
        point = glm::clamp(a + (mesh.corner(id, 1) - a) / 8 * within(0, 8) +
                               (mesh.corner(id, 2) - a) / 8 * within(0, 8) +
                               Int3(within(-1, 1), within(-1, 1), within(-1, 1)),
                           low, low + Int3(kVoxel - 1));
      }
      if (point == middle) continue;
      int exactly = 0;
      for (const std::uint32_t id : partition.list(boundary))
        exactly += exact::segment_crossing(point, middle,
                                           {mesh.corner(id, 0), mesh.corner(id, 1), mesh.corner(id, 2)});
      const MiddleCrossings::Net net = crossings.crossed(point - middle, boundary);
      ++asked;
      unsure += net.unsure ? 1 : 0;
      crossed += exactly != 0 ? 1 : 0;
      ASSERT_TRUE(net.unsure || net.crossed == exactly) << point.x << " " << point.y << " " << point.z;
    }
    EXPECT_LT(unsure, asked / 4);
    EXPECT_GT(crossed, asked / 20);
  }
}

TEST(SolidCubes, ThoseAreNearThatMayBeNoFurther) {
  std::mt19937 random(3);
  for (const Int3& n : {Int3(8, 8, 8), Int3(72, 16, 24), Int3(128, 8, 16)})
    for (const double distance : {0.5, 3.9, 4.0, 30.0}) {
      constexpr double kSide = 4;
      SolidCubes cubes(n, kSide);
      std::vector<Int3> solid;
      for (int i = 0; i < 12; ++i) {
        solid.emplace_back(random() % static_cast<unsigned>(n.x), random() % static_cast<unsigned>(n.y),
                           random() % static_cast<unsigned>(n.z));
        cubes.add(solid.back().x, solid.back().y, solid.back().z);
      }
      const std::vector<std::uint32_t> near = cubes.near(distance);
      std::size_t i = 0, more = 0, all = 0;
      Int3 c;
      for (c.z = 0; c.z < n.z; ++c.z)
        for (c.y = 0; c.y < n.y; ++c.y)
          for (c.x = 0; c.x < n.x; ++c.x, ++i) {
            double least = HUGE_VAL;  // between points of the cubes
            for (const Int3& s : solid) {
              double sum = 0;
              for (int k = 0; k < 3; ++k) sum += std::pow(std::max(std::abs(c[k] - s[k]) - 1, 0) * kSide, 2);
              least = std::min(least, std::sqrt(sum));
            }
            const bool said = (near[i >> 5] >> (i & 31) & 1) != 0;
            ASSERT_TRUE(said || least >= distance) << c.x << " " << c.y << " " << c.z;
            all += said ? 1u : 0u;
            more += said && least > distance + kSide ? 1u : 0u;
          }
      EXPECT_EQ(more, 0u) << "a cube further at most";
      EXPECT_GT(all, 0u);
    }
}

}  // namespace
}  // namespace palpate

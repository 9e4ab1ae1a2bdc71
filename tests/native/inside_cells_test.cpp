#include "compute/native/narrow_phase/inside_cells.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <random>
#include <string>
#include <vector>

#include "compute/native/narrow_phase/inside_search.h"
#include "compute/native/prepare/partition_build.h"
#include "compute/scene/search_tables.h"
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
    const HostPartition partition(view);
    const std::vector<std::uint8_t> boxes = SearchTables::boxes_of(mesh, view);
    InsideSearch plain(mesh, partition, boxes);
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

}  // namespace
}  // namespace palpate

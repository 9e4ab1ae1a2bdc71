#include "compute/ray_packet.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <memory>
#include <random>
#include <tuple>
#include <vector>

#include "compute/tool_order.h"
#include "tests/compute/geometry_cases.h"
#include "tests/compute/probe_cases.h"

namespace palpate {
namespace {

/// A tool of triangles that need not be closed, and rays through it.
struct Scene {
  LatticeMesh tool;
  LatticePose pose;
  std::vector<Int3> points;
  Int3 along{0};
  std::vector<std::uint32_t> order;
};

void add(LatticeMesh& tool, const Int3 (&corner)[3], bool collapsed = false) {
  const auto first = static_cast<std::uint32_t>(tool.vertices.size());
  tool.vertices.insert(tool.vertices.end(), {corner[0], corner[1], corner[2]});
  tool.triangles.push_back({first, first + 1, first + 2});
  tool.flags.push_back(collapsed ? std::uint8_t{kTriangleCollapsed} : std::uint8_t{0});
}

LatticePose unturned(const Int3& translation) {
  LatticePose pose;
  for (std::size_t k = 0; k < 3; ++k) pose.rotation_q30[k][k] = 1 << 30;
  pose.translation = translation;
  return pose;
}

/// About a random axis, any angle.
LatticePose turned(std::mt19937_64& engine, const Int3& translation) {
  std::normal_distribution<double> normal;
  double q[4], size = 0;
  for (double& v : q) {
    v = normal(engine);
    size += v * v;
  }
  for (double& v : q) v /= std::sqrt(size);
  const auto [w, x, y, z] = std::tuple(q[0], q[1], q[2], q[3]);
  const double r[3][3] = {{1 - 2 * (y * y + z * z), 2 * (x * y - w * z), 2 * (x * z + w * y)},
                          {2 * (x * y + w * z), 1 - 2 * (x * x + z * z), 2 * (y * z - w * x)},
                          {2 * (x * z - w * y), 2 * (y * z + w * x), 1 - 2 * (x * x + y * y)}};
  LatticePose pose;
  for (std::size_t i = 0; i < 3; ++i)
    for (std::size_t k = 0; k < 3; ++k) pose.rotation_q30[i][k] = static_cast<std::int32_t>(std::lround(r[i][k] * 0x1p30));
  pose.translation = translation;
  return pose;
}

/// Some triangles and rays among them; half of them on grids where rays pass through corners and edges and lie in planes.
Scene scene(std::uint64_t seed) {
  Scene out;
  LatticePoints points(seed);
  std::mt19937_64 engine(seed);
  const bool coarse = seed % 2 == 0;
  const int reach = coarse ? 3 : 1 << (4 + seed % 23), unit = coarse ? 1 << (seed / 2 % 24) : 1;
  const auto point = [&] { return unit * Int3(points.within(reach), points.within(reach), points.within(reach)); };
  const std::size_t triangles = 1 + engine() % 300;
  while (out.tool.triangles.size() < triangles) {
    Int3 t[3] = {point(), point(), point()};
    if (engine() % 2 == 0)   // a small one
      for (Int3& corner : t) corner = t[0] + (coarse ? corner - t[0] : (corner - t[0]) / 16);
    add(out.tool, t, LatticePoints::normal(t) == Long3(0) || engine() % 16 == 0);
  }
  const Int3 at(points.within(1 << 26), points.within(1 << 26), points.within(1 << 26));
  out.pose = coarse || seed % 3 == 0 ? unturned(at) : turned(engine, at);
  const std::size_t rays = triangles / 16 + 1 + engine() % (seed % 16 == 7 ? 4'000 : 200);
  for (std::size_t i = 0; i < rays; ++i) out.points.push_back(at + point());
  Int3 d(0);
  while (d == Int3(0)) d = coarse ? Int3(points.within(1), points.within(1), points.within(1)) : Int3(points.within(1 << 28), points.within(1 << 28), points.within(1 << 28));
  out.along = probe_cases::as_direction(d);
  out.order = order_in_space(out.tool);
  return out;
}

using Crossed = std::tuple<std::uint32_t, std::int32_t, std::uint32_t>;   // triangle, sign, height

struct Count {
  std::size_t crossed = 0, known = 0, asked = 0, packets = 0;
};

/// Holds a packet against the exact test of every ray with every triangle.
void compare(const Scene& s, Count& count) {
  const RunTree runs(s.tool, s.order);
  RayPacket packet(s.tool, runs);
  PosedTool tool(s.tool);
  tool.begin(s.pose);
  if (!packet.trace(tool, s.points, s.along)) return;
  ++count.packets;
  for (std::size_t i = 0; i < s.points.size(); ++i) {
    std::vector<Crossed> expected, found;
    for (std::uint32_t id = 0; id < s.tool.triangles.size(); ++id) {
      if (s.tool.collapsed(id)) continue;
      const exact::Crossing crossing = exact::ray_crossing(s.points[i], s.along, tool.corners(id));
      if (crossing.sign != 0) expected.emplace_back(id, crossing.sign, crossing.height);
    }
    packet.for_hits(i, [&](const RayPacket::Hit& hit) {
      if (hit.sign != 0) {
        ++count.known;
        found.emplace_back(hit.id, hit.sign, hit.height);
        return;
      }
      ++count.asked;
      const exact::Crossing crossing = exact::ray_crossing(s.points[i], s.along, tool.corners(hit.id));
      if (crossing.sign != 0) found.emplace_back(hit.id, crossing.sign, crossing.height);
    });
    std::sort(found.begin(), found.end());
    ASSERT_EQ(found, expected) << "ray " << i;
    count.crossed += expected.size();
  }
}

TEST(RayPacket, CrossesWhatEachRayDoes) {
  Count count;
  for (std::uint64_t seed = 0; seed < 1'000; ++seed) {
    SCOPED_TRACE(seed);
    compare(scene(seed), count);
    if (HasFatalFailure()) return;
  }
  EXPECT_GT(count.packets, 600u);   // of others more crossings than are kept
  EXPECT_GT(count.crossed, 100'000u);
  EXPECT_GT(count.known, 100'000u);
  EXPECT_GT(count.asked, 10'000u);
}

TEST(RayPacket, LeavesHardlyAnyOfGeneralPositionOpen) {
  Count count;
  for (std::uint64_t seed = 29; seed < 1'000; seed += 46) {   // up to 2^27 steps
    SCOPED_TRACE(seed);
    compare(scene(seed), count);
    if (HasFatalFailure()) return;
  }
  EXPECT_GT(count.known, 1'000u);
  EXPECT_LT(count.asked, count.known / 100);
}

/// Rays through corners and middles of edges, along directions whose shear no double holds: only the bound keeps rounding from telling a side.
TEST(RayPacket, LeavesRaysThroughEdgesOpen) {
  Count count;
  for (std::uint64_t seed = 1; seed <= 200; ++seed) {
    LatticePoints points(seed);
    Scene s;
    Int3 d(0);
    while (d.x == 0 || d.y == 0 || d.z == 0) d = Int3(points.within(9), points.within(9), points.within(9));
    s.along = probe_cases::as_direction(d);
    const int reach = 1 << (4 + seed % 20);
    for (int i = 0; i < 20; ++i) {
      const auto point = [&] { return 2 * Int3(points.within(reach), points.within(reach), points.within(reach)); };   // edges have middles
      const Int3 t[3] = {point(), point(), point()};
      add(s.tool, t, LatticePoints::normal(t) == Long3(0));
      for (std::size_t k = 0; k < 3; ++k)
        for (const Int3& met : {t[k], (t[k] + t[(k + 1) % 3]) / 2}) s.points.push_back(met - (1 + std::abs(points.within(reach))) * d);
    }
    s.pose = unturned(Int3(0));
    s.order = order_in_space(s.tool);
    SCOPED_TRACE(seed);
    compare(s, count);
    if (HasFatalFailure()) return;
  }
  EXPECT_EQ(count.packets, 200u);
  EXPECT_GT(count.asked, 20'000u);
}

/// A single square, without a width.
TEST(RayPacket, OfOneRayIsThatRay) {
  Count count;
  for (std::uint64_t seed = 1; seed < 400; ++seed) {
    Scene s = scene(seed);
    s.points.resize(1);
    s.tool.triangles.resize(std::min<std::size_t>(s.tool.triangles.size(), 8));
    s.order = order_in_space(s.tool);
    SCOPED_TRACE(seed);
    compare(s, count);
    if (HasFatalFailure()) return;
  }
  EXPECT_EQ(count.packets, 399u);
}

/// Whether the scene's rays are traced together.
bool worthwhile(const Scene& s) {
  const RunTree runs(s.tool, s.order);
  RayPacket packet(s.tool, runs);
  PosedTool tool(s.tool);
  tool.begin(s.pose);
  return packet.trace(tool, s.points, s.along);
}

TEST(RayPacket, IsNotWorthwhileForFewRaysOfManyTriangles) {
  Scene s;
  Int3 t[3] = {Int3(-8, -8, 0), Int3(8, -8, 0), Int3(0, 8, 0)};
  for (int z = 0; z < 400; ++z) {
    for (Int3& corner : t) corner.z = z;
    add(s.tool, t);
  }
  s.pose = unturned(Int3(0));
  s.along = Int3(0, 0, 1 << 28);
  s.order = order_in_space(s.tool);
  s.points = {Int3(0, 0, -1)};
  EXPECT_FALSE(worthwhile(s));
  s.points = {Int3(0, 0, 396)};   // four before it
  EXPECT_TRUE(worthwhile(s));
  s.points.assign(50, Int3(0, 0, -1));   // more crossings than are kept
  EXPECT_FALSE(worthwhile(s));
}

TEST(RayPacket, IsNotWorthwhileForFewRaysOfLongTriangles) {
  constexpr int reach = 1 << 20;
  Scene s;
  for (int z = 0; z < 600; ++z) {
    const Int3 t[3] = {Int3(-reach, -reach, z), Int3(reach, reach - 1000, z), Int3(reach, reach, z)};
    add(s.tool, t);
  }
  s.pose = unturned(Int3(0));
  s.along = Int3(0, 0, 1 << 28);
  s.order = order_in_space(s.tool);
  const auto rays = [&](int side) {
    s.points.clear();
    for (int x = 0; x < side; ++x)
      for (int y = 0; y < side; ++y) s.points.emplace_back(reach * (2 * x - side) / side, reach * (2 * y - side) / side + 7, -1);
  };
  rays(8);
  EXPECT_FALSE(worthwhile(s));
  rays(80);
  EXPECT_TRUE(worthwhile(s));
  Count count;
  compare(s, count);
  EXPECT_EQ(count.packets, 1u);
}

}  // namespace
}  // namespace palpate

#include <map>
#include <numeric>
#include <random>
#include <set>

#include "tests/compute/response_bench.h"

namespace palpate {
namespace {

using Areas = ResponseTest;
using gpu::ivec3;

/// `count` separate small triangles in a row along x, none of them joined.
ResponseCase row_of_triangles(std::uint32_t count) {
  ResponseCase c;
  for (std::uint32_t i = 0; i < count; ++i) {
    const int x = static_cast<int>(10 * i);
    c.mockup_triangles.emplace_back(3 * i, 3 * i + 1, 3 * i + 2);
    for (const ivec3 v : {ivec3(x, 0, 0), ivec3(x + 8, 0, 0), ivec3(x, 8, 0)}) c.mockup_vertices.push_back(v);
  }
  c.mockup_normals.assign(count, ivec3(0, 0, 1 << 30));
  c.mockup_info.assign(count, 2u << gpu::kInfoAxisShift);
  c.mockup_weights.assign(count, 1u << 30);
  c.neighbours.resize(count);
  c.seams.resize(count);
  c.static_state.assign(count, 0);
  return c;
}

void put_in_contact(ResponseCase& c, std::uint32_t id, std::uint32_t state = gpu::kStaticHit) {
  c.static_state[id] = state;
  c.contact_statics.push_back(id);
}

void join(ResponseCase& c, std::uint32_t a, std::uint32_t b, bool smooth) {
  c.neighbours[a].push_back(2 * b + (smooth ? 1 : 0));
  c.neighbours[b].push_back(2 * a + (smooth ? 1 : 0));
}

void sort_neighbours(ResponseCase& c) {
  for (auto& list : c.neighbours) {
    std::sort(list.begin(), list.end());
    // Each neighbour once; it is smooth if any shared edge is.
    for (std::size_t i = 1; i < list.size();)
      if (list[i] >> 1 == list[i - 1] >> 1) {
        list[i - 1] |= list[i];
        list.erase(list.begin() + static_cast<std::ptrdiff_t>(i));
      } else {
        ++i;
      }
  }
  for (auto& list : c.seams) std::sort(list.begin(), list.end());
}

/// The smallest id that each triangle of C_s can reach, by plain flooding.
std::map<std::uint32_t, std::uint32_t> flood(const ResponseCase& c, bool only_smooth) {
  std::map<std::uint32_t, std::uint32_t> smallest;
  for (std::uint32_t id = 0; id < c.static_state.size(); ++id) {   // ascending: the first to arrive is the smallest
    if (c.static_state[id] == 0 || smallest.contains(id)) continue;
    std::vector<std::uint32_t> todo{id};
    smallest[id] = id;
    while (!todo.empty()) {
      const std::uint32_t at = todo.back();
      todo.pop_back();
      std::vector<std::uint32_t> next = c.seams[at];
      for (const std::uint32_t n : c.neighbours[at])
        if (!only_smooth || n & 1) next.push_back(n >> 1);
      for (const std::uint32_t n : next)
        if (c.static_state[n] != 0 && smallest.emplace(n, id).second) todo.push_back(n);
    }
  }
  return smallest;
}

// The whole of C_s hangs together in long chains, in a shuffled order of slots: the worst for a union-find in parallel.
TEST_F(Areas, EqualAFloodOverARandomGraphOfLongChains) {
  for (const std::uint32_t seed : {1u, 2u, 3u}) {
    std::mt19937 random(seed);
    const std::uint32_t count = 20000;
    ResponseCase c = row_of_triangles(count);
    std::vector<std::uint32_t> order(count);
    std::iota(order.begin(), order.end(), 0u);
    std::shuffle(order.begin(), order.end(), random);
    for (std::uint32_t i = 0; i < count; ++i)
      if (random() % 200 != 0) put_in_contact(c, i);
    std::shuffle(c.contact_statics.begin(), c.contact_statics.end(), random);
    // Chains in id order, in shuffled order, and a few seams.
    for (std::uint32_t i = 0; i + 1 < count; ++i) {
      if (i % 97 != 0) join(c, i, i + 1, random() % 3 != 0);
      if (random() % 50 == 0) join(c, order[i], order[i + 1], random() % 2 == 0);
    }
    for (int k = 0; k < 20; ++k) {
      const auto a = static_cast<std::uint32_t>(random() % count), b = static_cast<std::uint32_t>(random() % count);
      if (a == b) continue;
      c.seams[a].push_back(b);
      c.seams[b].push_back(a);
    }
    sort_neighbours(c);

    const ResponseAnswer answer = run(c);
    ASSERT_EQ(answer.state.overflow_other, 0u);
    const auto area_of = flood(c, false), zone_of = flood(c, true);
    std::set<std::uint32_t> ids;
    for (const auto& [id, area] : area_of) ids.insert(area);
    ASSERT_EQ(answer.area_count, ids.size());
    std::map<std::uint32_t, std::uint32_t> zone_names;   // GPU's name of a zone → ours
    for (std::size_t slot = 0; slot < c.contact_statics.size(); ++slot) {
      const std::uint32_t id = c.contact_statics[slot];
      ASSERT_LT(answer.statics[slot].area, answer.area_count);
      ASSERT_EQ(answer.areas[answer.statics[slot].area].id, area_of.at(id));
      ASSERT_EQ(zone_names.emplace(answer.statics[slot].zone, zone_of.at(id)).first->second, zone_of.at(id));
    }
    std::set<std::uint32_t> zones;
    for (const auto& [id, zone] : zone_of) zones.insert(zone);
    EXPECT_EQ(zone_names.size(), zones.size());
  }
}

TEST_F(Areas, BeyondTheCapacityAreReportedNotCut) {
  ResponseCase c = row_of_triangles(gpu::kMaxFrameAreas + 1);
  for (std::uint32_t i = 0; i < c.static_state.size(); ++i) put_in_contact(c, i);
  const ResponseAnswer answer = run(c);
  EXPECT_STREQ(overflow_name(answer.state), "areas");
  c.contact_statics.pop_back();
  c.static_state.back() = 0;
  const ResponseAnswer fits = run(c);
  EXPECT_EQ(fits.state.overflow_other, 0u);
  EXPECT_EQ(fits.area_count, gpu::kMaxFrameAreas);
}

/// A closed box of the tool, outward faces: appended.
void add_box(ResponseCase& c, ivec3 low, ivec3 high, bool inside_out = false) {
  const auto first = static_cast<std::uint32_t>(c.tool_world.size());
  for (int i = 0; i < 8; ++i) c.tool_world.emplace_back(i & 1 ? high.x : low.x, i & 2 ? high.y : low.y, i & 4 ? high.z : low.z);
  constexpr std::uint32_t faces[12][3] = {{0, 2, 1}, {1, 2, 3}, {4, 5, 6}, {5, 7, 6}, {0, 1, 4}, {1, 5, 4},
                                          {2, 6, 3}, {3, 6, 7}, {0, 4, 2}, {2, 4, 6}, {1, 3, 5}, {3, 7, 5}};
  for (const auto& f : faces)
    c.tool_triangles.emplace_back(first + f[0], first + (inside_out ? f[2] : f[1]), first + (inside_out ? f[1] : f[2]));
}

/// One triangle in the plane z = 0 facing up, in contact, with one sample at (100, 100, 0).
ResponseCase one_sample() {
  ResponseCase c;
  c.mockup_vertices = {ivec3(0, 0, 0), ivec3(400, 0, 0), ivec3(0, 400, 0)};
  c.mockup_triangles = {{0, 1, 2}};
  c.mockup_normals = {ivec3(0, 0, 1 << 30)};
  c.mockup_info = {2u << gpu::kInfoAxisShift};
  c.mockup_weights = {1u << 30};
  c.neighbours.resize(1);
  c.seams.resize(1);
  c.static_state = {0};
  put_in_contact(c, 0);
  c.samples = {{ivec3(100, 100, 0), 0}};
  return c;
}

/// D is (0, 0, 2^28) there: a crossing at depth z has H = z · 2^30 / 2^28.
std::uint32_t height_at(int depth) { return static_cast<std::uint32_t>(depth) * 4; }

TEST_F(Areas, TheHeightEndsWhereTheWindingFirstFallsToZero) {
  ResponseCase c = one_sample();
  add_box(c, {0, 0, -50}, {300, 300, 50});     // two that overlap: leaving the first is not out yet
  add_box(c, {0, 0, -120}, {300, 300, -20});
  add_box(c, {0, 0, -300}, {300, 300, -200});  // one further down, beyond the outside
  const ResponseAnswer answer = run(c);
  ASSERT_EQ(answer.area_count, 1u);
  const gpu::AreaResult& area = answer.areas[0];
  EXPECT_EQ(area.direction, ivec3(0, 0, 1 << 28));
  EXPECT_EQ(area.rays, 1u);
  EXPECT_EQ(area.max_height, height_at(120));
  EXPECT_EQ(area.weight_sum, std::int64_t{1} << 30);
  EXPECT_EQ(area.height_sum, height_at(120));
  EXPECT_EQ(area.moment_low[0], 100 * std::int64_t{height_at(120)});
  EXPECT_EQ(area.moment_high[0], 0);
}

// 30 boxes that each overlap the next one: 60 distinct crossings, so that one sweep of eight heights can't be enough. Large
// coordinates, so that the float culling has something to cull.
TEST_F(Areas, AHeightBeyondManyCrossingsIsNotCutOff) {
  ResponseCase c = one_sample();
  constexpr int kBig = 10000;
  for (ivec3& v : c.mockup_vertices) v *= kBig;
  c.samples[0].point *= kBig;
  for (int i = 0; i < 30; ++i) add_box(c, ivec3(0, 0, -40 - 30 * i) * kBig, ivec3(300, 300, 10 - 30 * i) * kBig);
  const ResponseAnswer answer = run(c);
  EXPECT_EQ(answer.state.overflow_other, 0u);
  EXPECT_EQ(answer.areas.at(0).max_height, height_at((40 + 30 * 29) * kBig));
}

// The same many crossings with nothing to cull cost more than an invocation may spend: told, not cut off.
TEST_F(Areas, ARayBeyondTheLoopBudgetIsReported) {
  ResponseCase c = one_sample();
  for (int i = 0; i < 90; ++i) add_box(c, {0, 0, -40 - 30 * i}, {300, 300, 10 - 30 * i});
  EXPECT_TRUE(run(c).state.overflow_other & gpu::kOverflowLoop);
}

// Equal heights happen together: faces that coincide, one leaving and one entering, leave the winding as it was.
TEST_F(Areas, FacesThatCoincideAreOneCrossing) {
  ResponseCase c = one_sample();
  add_box(c, {0, 0, -50}, {300, 300, 50});
  add_box(c, {0, 0, -90}, {300, 300, -50});
  EXPECT_EQ(run(c).areas.at(0).max_height, height_at(90));
}

TEST_F(Areas, AnOpenToolWithoutInsideTakesTheNearestHit) {
  ResponseCase c = one_sample();
  c.tool_closed = false;
  add_box(c, {0, 0, -50}, {300, 300, -10}, true);
  const ResponseAnswer answer = run(c);
  EXPECT_EQ(answer.areas.at(0).max_height, height_at(10));
  EXPECT_TRUE(answer.areas.at(0).flags & gpu::kAreaFlagToolOpen);
}

TEST_F(Areas, ARayThatMeetsNothingIsNoHeight) {
  ResponseCase c = one_sample();
  c.static_state[0] = gpu::kStaticSampled;   // no CST: no needle either
  add_box(c, {200, 200, -50}, {300, 300, 50});
  const ResponseAnswer answer = run(c);
  EXPECT_EQ(answer.areas.at(0).rays, 0u);
  EXPECT_EQ(answer.areas.at(0).flags, 0u);
}

// A plate z ∈ [−20, 0] with two faces that are no neighbours, a tool right through: the ray of the upper sample runs down
// to −100 and crosses the lower face first, leaving. The lower face's ray runs up.
TEST_F(Areas, APlateIsPiercedFromBothSides) {
  ResponseCase c = one_sample();
  for (const ivec3 v : {ivec3(0, 0, -20), ivec3(0, 400, -20), ivec3(400, 0, -20)}) c.mockup_vertices.push_back(v);
  c.mockup_triangles.emplace_back(3, 4, 5);
  c.mockup_normals.emplace_back(0, 0, -(1 << 30));
  c.mockup_info.push_back(2u << gpu::kInfoAxisShift);
  c.mockup_weights.push_back(1u << 30);
  c.neighbours.resize(2);
  c.seams.resize(2);
  c.static_state.push_back(0);
  put_in_contact(c, 1);
  c.samples.push_back({ivec3(100, 100, -20), 1});
  add_box(c, {50, 50, -100}, {300, 300, 60});
  const ResponseAnswer answer = run(c);
  ASSERT_EQ(answer.area_count, 2u);
  const std::uint32_t upper = answer.areas[0].id == 0 ? 0 : 1;
  EXPECT_EQ(answer.areas[upper].max_height, height_at(100));
  EXPECT_EQ(answer.areas[1 - upper].max_height, height_at(80));
  std::set<std::pair<std::uint32_t, std::uint32_t>> pierces;
  for (const auto& p : answer.pierces) pierces.emplace(p.area, p.pierced);
  EXPECT_EQ(pierces, (std::set<std::pair<std::uint32_t, std::uint32_t>>{{0, 1}, {1, 0}}));
}

// The side of a sheet is the one where the tool's centre of mass (the origin of its frame, here of the world too) lies.
TEST_F(Areas, ASheetFacesTheToolsCentreOfMass) {
  for (const int z : {-30, 30}) {
    ResponseCase c = one_sample();
    c.mockup_info[0] |= gpu::kInfoSheet;
    for (ivec3& v : c.mockup_vertices) v.z = z;
    c.samples[0].point.z = z;
    const ResponseAnswer answer = run(c);
    ASSERT_EQ(answer.area_count, 1u);
    const int sign = z < 0 ? 1 : -1;
    EXPECT_EQ(answer.areas[0].sheet_sign, sign);
    EXPECT_EQ(answer.areas[0].direction, ivec3(0, 0, sign * (1 << 28)));
    EXPECT_TRUE(answer.areas[0].flags & gpu::kAreaFlagSheet);

    c.held_areas = {{ivec3(0, 0, 1 << 28), -sign}};
    c.held_statics = {{0, 0}};
    const ResponseAnswer held = run(c);
    EXPECT_EQ(held.areas.at(0).sheet_sign, -sign);
    EXPECT_TRUE(held.areas.at(0).flags & gpu::kAreaFlagHeld);
  }
}

// Of two held areas the one with more common triangles speaks, and only when no normal does.
TEST_F(Areas, CancelledNormalsLeaveTheWordToTheHeldArea) {
  ResponseCase c = row_of_triangles(4);
  for (std::uint32_t i = 0; i < 4; ++i) put_in_contact(c, i);
  for (std::uint32_t i = 0; i < 3; ++i) join(c, i, i + 1, true);
  sort_neighbours(c);
  for (const std::uint32_t i : {1u, 3u}) c.mockup_normals[i] = ivec3(0, 0, -(1 << 30));
  for (std::uint32_t i = 0; i < 4; ++i) c.samples.push_back({ivec3(static_cast<int>(10 * i) + 1, 1, 0), i});
  c.held_areas = {{ivec3(1 << 28, 0, 0), 0}, {ivec3(0, 1 << 28, 0), 0}};
  c.held_statics = {{0, 0}, {1, 1}, {2, 1}};
  const ResponseAnswer answer = run(c);
  ASSERT_EQ(answer.area_count, 1u);
  EXPECT_EQ(answer.areas[0].direction, ivec3(0, 1 << 28, 0));
  EXPECT_EQ(answer.areas[0].flags, gpu::kAreaFlagCancelled | gpu::kAreaFlagHeld | gpu::kAreaFlagNeedle);

  // Without anybody held: towards the nearest V_ext voxel. The grid is all V_ext here, voxels of 256 from −1024; the area's
  // centre (19, 4, 0) is in the voxel with the centre (128, 128, 128).
  c.held_areas.clear();
  c.held_statics.clear();
  const ResponseAnswer lone = run(c);
  EXPECT_EQ(lone.areas.at(0).flags, gpu::kAreaFlagCancelled | gpu::kAreaFlagNearestExternal | gpu::kAreaFlagNeedle);
  // (109, 124, 128) shifted up by 21: 128 · 2^21 = 2^28. A tie below z = 0 would have the smaller number: centre z = −128.
  EXPECT_EQ(lone.areas.at(0).direction, ivec3(109 << 21, 124 << 21, -128 * (1 << 21)));
}

}  // namespace
}  // namespace palpate

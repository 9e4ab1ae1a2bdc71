#include "compute/native/narrow_phase/pair_filter.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdlib>
#include <random>
#include <utility>
#include <vector>

#include "compute/native/broad_phase/listed_boxes.h"
#include "compute/native/broad_phase/turned_boxes.h"
#include "compute/native/narrow_phase/crossing.h"
#include "compute/scene/search_tables.h"
#include "tests/compute/geometry_cases.h"

namespace palpate {
namespace {

using exact::Corners;

struct Pair {
  Corners s, t;
};

std::vector<PairFilter::Verdict> judge(const std::vector<Pair>& pairs) {
  PairFilter filter;
  std::array<PairFilter::Verdict, PairFilter::kLanes> verdicts{};
  std::vector<PairFilter::Verdict> out;
  for (std::size_t begin = 0; begin < pairs.size(); begin += PairFilter::kLanes) {
    const std::size_t count = std::min(PairFilter::kLanes, pairs.size() - begin);
    for (std::size_t lane = 0; lane < count; ++lane)
      filter.put(lane, pairs[begin + lane].s, pairs[begin + lane].t);
    filter.judge(verdicts);
    out.insert(out.end(), verdicts.begin(), verdicts.begin() + static_cast<std::ptrdiff_t>(count));
  }
  return out;
}

/// How many verdicts there are of each kind; those that say something are held against exact arithmetic.
std::array<std::size_t, 3> count_right(const std::vector<Pair>& pairs) {
  const std::vector<PairFilter::Verdict> verdicts = judge(pairs);
  std::array<std::size_t, 3> count{};
  for (std::size_t i = 0; i < pairs.size(); ++i) {
    ++count[verdicts[i]];
    if (verdicts[i] == PairFilter::kUnknown) continue;
    EXPECT_EQ(verdicts[i] == PairFilter::kMeet,
              exact::triangles_meet(pairs[i].s, pairs[i].t, exact::raw_normal(pairs[i].t)))
        << "pair " << i;
  }
  return count;
}

TEST(PairFilter, NeverSaysWhatIsNotSo) {
  LatticePoints points(1);
  std::vector<Pair> pairs;
  for (int i = 0; i < 40'000; ++i) {
    points.choose();
    Int3 s[3], t[3];
    points.triangle(s);
    points.triangle(t);
    pairs.push_back({{s[0], s[1], s[2]}, {t[0], t[1], t[2]}});
  }
  const auto count = count_right(pairs);
  // Half of them lie on grids where corners, edges and planes coincide.
  EXPECT_GT(count[PairFilter::kMeet], 3'000u);
  EXPECT_GT(count[PairFilter::kApart], 10'000u);
  EXPECT_GT(count[PairFilter::kUnknown], 2'000u);
}

TEST(PairFilter, DecidesNearlyAllOfGeneralPosition) {
  LatticePoints points(2);
  std::vector<Pair> pairs;
  for (int i = 0; i < 4'000; ++i) {
    Corners c[2];
    for (Corners& corners : c)
      for (Int3& corner : corners)
        corner = Int3(points.within(1 << 28), points.within(1 << 28), points.within(1 << 28));
    pairs.push_back({c[0], c[1]});
  }
  const auto verdicts = judge(pairs);
  // Fifteen signs a pair are 60,000, each unknown in some 2^-16 of its range: about one, and not every sign
  // decides. Triangles that are thin by chance: a few more.
  EXPECT_LE(std::count(verdicts.begin(), verdicts.end(), PairFilter::kUnknown), 4);
}

/// A triangle, and itself moved off its plane so that each of its corners has `low` + p (p + 1) `high` as the
/// sixfold volume with it, p = 2^20.
Pair lifted(std::int32_t low, std::int32_t high) {
  constexpr std::int32_t p = 1 << 20;
  // The normal is (p + 1, −p (p + 1), p).
  const Corners t{Int3(0), Int3(p, 1, 0), Int3(0, 1, p + 1)};
  Pair out{t, t};
  for (Int3& corner : out.s) corner += Int3(low, -high, -low);
  return out;
}

TEST(PairFilter, SaysNothingWithinItsBound) {
  // Of both triangles and their sides the largest component is 2^20 and a little, so the bound is 2^-17 ·
  // 2^60 · 2 and a little: 16 times 2^40.
  constexpr std::int64_t kHigh = (std::int64_t{1} << 20) * ((1 << 20) + 1);
  for (const auto& [low, high] :
       {std::pair{0, 0}, {1, 0}, {-1, 0}, {1 << 15, 0}, {0, 1}, {0, -1}, {0, 15}, {0, -15}}) {
    const Pair pair = lifted(low, high);
    const auto n = exact::raw_normal(pair.t);
    for (const Int3& corner : pair.s) ASSERT_EQ(exact::dot(n, corner - pair.t[0]), low + high * kHigh);
    EXPECT_EQ(judge({pair})[0], PairFilter::kUnknown) << low << " " << high;
    EXPECT_EQ(exact::triangles_meet(pair.s, pair.t, n), low == 0 && high == 0) << low << " " << high;
  }
  for (const std::int32_t high : {17, -17, 1 << 10})
    EXPECT_EQ(judge({lifted(0, high)})[0], PairFilter::kApart) << high;
}

/// Signs that are known are right also where one triangle is far smaller than the other, or far from its
/// first corner.
TEST(PairFilter, NeverSaysWhatIsNotSoOfTrianglesOfAllSizes) {
  std::mt19937_64 random(5);
  const auto within = [&](std::int32_t most) {
    return static_cast<std::int32_t>(random() % (2 * static_cast<std::uint64_t>(most) + 1)) - most;
  };
  std::vector<Pair> pairs;
  for (int i = 0; i < 60'000; ++i) {
    const std::int32_t large = 1 << random() % 28, small = 1 << random() % 12;
    Corners t, s;
    for (Int3& corner : t) corner = Int3(within(large), within(large), within(large));
    // Somewhere near t's plane, edges or corners: whole eighths of its sides, and a little beside.
    const std::int64_t u = static_cast<std::int64_t>(random() % 9),
                       v = static_cast<std::int64_t>(random() % 9);
    Int3 near;
    for (int k = 0; k < 3; ++k)
      near[k] = static_cast<std::int32_t>(t[0][k] + (u * (t[1][k] - t[0][k]) + v * (t[2][k] - t[0][k])) / 8);
    for (Int3& corner : s)
      corner = glm::clamp(near + Int3(within(small), within(small), within(small)), Int3(-(1 << 28)),
                          Int3(1 << 28));
    if (exact::raw_normal(s) == exact::Normal{} || exact::raw_normal(t) == exact::Normal{}) continue;
    pairs.push_back(i % 2 == 0 ? Pair{s, t} : Pair{t, s});
  }
  const auto count = count_right(pairs);
  EXPECT_GT(count[PairFilter::kMeet], 5'000u);
  EXPECT_GT(count[PairFilter::kApart], 5'000u);
}

TEST(PairFilter, ReachesTheEndsOfTheLattice) {
  constexpr std::int32_t end = 1 << 28;
  const Corners t{Int3(-end, -end, 0), Int3(end, -end, 0), Int3(0, end, 0)};
  EXPECT_EQ(judge({{{Int3(0, 0, -end), Int3(1, 0, end), Int3(0, 1, end)}, t}})[0], PairFilter::kMeet);
  EXPECT_EQ(judge({{{Int3(end, end, -end), Int3(end, end, end), Int3(end - 1, end, end)}, t}})[0],
            PairFilter::kApart);
  EXPECT_EQ(judge({{{Int3(-end, -end, 0), Int3(-end, -end, end), Int3(-end, end, end)}, t}})[0],
            PairFilter::kUnknown);  // they share a corner
}

TEST(SegmentCrossing, NeverSaysWhatIsNotSo) {
  LatticePoints points(6);
  std::array<std::size_t, 3> count{};  // −1, 0 and 1
  for (int i = 0; i < 200'000; ++i) {
    points.choose();
    Int3 t[3];
    points.triangle(t);
    const Corners corners{t[0], t[1], t[2]};
    const Int3 p = points.point();
    Int3 q = points.point();
    if (i % 2 == 0) q[i % 3] = p[i % 3], q[(i + 1) % 3] = p[(i + 1) % 3];  // along an axis, as walks go
    if (p == q) continue;
    const int exactly = exact::segment_crossing(p, q, corners);
    ++count[static_cast<std::size_t>(exactly + 1)];
    ASSERT_EQ(segment_crossing(p, q, corners), exactly) << "round " << i;
  }
  for (const std::size_t kind : count) EXPECT_GT(kind, 5'000u);
}

/// Ways that pass a corner, an edge or the plane of a triangle by a step or meet it, far off and near.
TEST(SegmentCrossing, NeverSaysWhatIsNotSoOfNearMisses) {
  std::mt19937_64 random(7);
  const auto within = [&](std::int32_t most) {
    return static_cast<std::int32_t>(random() % (2 * static_cast<std::uint64_t>(most) + 1)) - most;
  };
  std::size_t crossed = 0;
  for (int i = 0; i < 200'000; ++i) {
    const std::int32_t large = 1 << (4 + random() % 25), way = 1 << (2 + random() % 26);
    const bool on_it = random() % 2 == 0;  // its eighths are whole steps, so that a way meets it just there
    Corners t;
    for (Int3& corner : t) {
      corner = Int3(within(large), within(large), within(large));
      if (on_it) corner = corner / 8 * 8;
    }
    const auto u = static_cast<std::int64_t>(random() % 9), v = static_cast<std::int64_t>(random() % 9);
    Int3 at;
    for (int k = 0; k < 3; ++k)
      at[k] = static_cast<std::int32_t>(t[0][k] + (u * (t[1][k] - t[0][k]) + v * (t[2][k] - t[0][k])) / 8) +
              (on_it ? 0 : within(1));
    const Int3 half(within(way), within(way), within(way));
    const Int3 p = random() % 4 == 0 ? at : at - half, q = at + half;
    if (p == q) continue;
    const int exactly = exact::segment_crossing(p, q, t);
    crossed += exactly != 0 ? 1 : 0;
    ASSERT_EQ(segment_crossing(p, q, t), exactly) << "round " << i;
  }
  EXPECT_GT(crossed, 20'000u);
}

/// A voxel's boxes as SearchTables has them, and a triangle's look at them.
struct BoxCase {
  std::vector<std::array<std::uint8_t, 6>> boxes;
  std::vector<std::uint8_t> rows;
  ListLook look{};

  BoxCase(std::mt19937& random, std::size_t count, int side)
      : boxes(count), rows(6 * count + SearchTables::kBoxesAtOnce) {
    const auto up_to = [&](int most) { return static_cast<int>(random() % static_cast<unsigned>(most + 1)); };
    for (std::uint8_t& byte : rows)
      byte = static_cast<std::uint8_t>(random());  // what lies behind must not matter
    for (std::size_t i = 0; i < count; ++i)
      for (std::size_t k = 0; k < 3; ++k) {
        const int low = up_to(255);
        boxes[i][k] = static_cast<std::uint8_t>(low);
        boxes[i][k + 3] = static_cast<std::uint8_t>(std::min(low + up_to(side), 255));
        rows[k * count + i] = boxes[i][k];
        rows[(k + 3) * count + i] = boxes[i][k + 3];
      }
    double size = 0;
    std::array<double, 3> normal{};
    for (double& n : normal)
      size += std::abs(n = up_to(9) == 0 ? 0 : std::uniform_real_distribution<double>(-1, 1)(random));
    for (std::size_t k = 0; k < 3; ++k) {
      look.facing[k] = size > 0 ? static_cast<float>(2 * normal[k] / size) : k == 0 ? 2.0F : 0.0F;
      look.box[k] = up_to(600) - 300;
      look.box[k + 3] = look.box[k] + up_to(300);
    }
    look.plane = std::uniform_real_distribution<float>(-600, 600)(random);
    look.slack = std::uniform_real_distribution<float>(1, 40)(random);
  }
  /// A box that reaches into the voxel's last part may go on beyond the voxel, and one out of the voxel has
  /// been cut off: so do the triangle's ends.
  bool boxes_meet(std::size_t i) const {
    for (std::size_t k = 0; k < 3; ++k)
      if (boxes[i][k] > std::clamp(look.box[k + 3], 0, kVoxelParts - 1) ||
          boxes[i][k + 3] < std::clamp(look.box[k], 0, kVoxelParts - 1))
        return false;
    return true;
  }
  /// By how much box i is clear of the plane, beyond the slack; below 0: not clear. Half parts.
  double clear(std::size_t i) const {
    double middle = look.plane, reach = look.slack;
    for (std::size_t k = 0; k < 3; ++k) {
      middle += 0.5 * look.facing[k] * (boxes[i][k] + boxes[i][k + 3]);
      reach += 0.5 * std::abs(look.facing[k]) * (boxes[i][k + 3] - boxes[i][k]);
    }
    return std::abs(middle) - reach;
  }
};

TEST(ListedBoxes, AreThoseThatMeetTheTriangleBoxAndItsPlane) {
  constexpr double kRounding =
      0x1p-10;  // six sums and products below 2^11 half parts in single precision, off by 2^-13 each at most
  std::mt19937 random(4);
  std::array<std::size_t, 4> count{};  // boxes apart, off the plane, met, unsure
  for (int round = 0; round < 16'000; ++round) {
    const std::size_t boxes = round % 8 == 0 ? kMostBoxes : 1 + random() % kMostBoxes;
    const BoxCase c(random, boxes, round % 3 == 0 ? 255 : 20);
    const std::uint64_t found = near_boxes(c.look, c.rows.data(), boxes, boxes);
    ASSERT_EQ(boxes < kMostBoxes ? found >> boxes : 0, 0u) << "beyond the list";
    for (std::size_t i = 0; i < boxes; ++i) {
      const bool meets = c.boxes_meet(i);
      const double clear = c.clear(i);
      ++count[!meets ? 0 : clear > kRounding ? 1 : clear < -kRounding ? 2 : 3];
      if (meets && std::abs(clear) <= kRounding) continue;
      ASSERT_EQ(found >> i & 1, meets && clear < 0 ? 1u : 0u) << "round " << round << ", box " << i;
    }
  }
  for (std::size_t kind = 0; kind < 3; ++kind) EXPECT_GT(count[kind], 3'000u) << kind;
  EXPECT_LT(100 * count[3], count[2]) << "nearly all are judged";
}

}  // namespace
}  // namespace palpate

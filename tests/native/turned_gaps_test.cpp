#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <random>
#include <vector>

#include "compute/native/queries/nearest_points.h"
#include "compute/native/queries/pair_distance.h"

namespace palpate::native {
namespace {

class Random {
 public:
  double some() { return std::uniform_real_distribution<double>(-1, 1)(bits_); }
  Int3 point(double most) {
    Int3 out;
    for (int k = 0; k < 3; ++k) out[k] = static_cast<std::int32_t>(std::lround(most * some()));
    return out;
  }
  unsigned below(unsigned end) { return static_cast<unsigned>(bits_() % end); }

 private:
  std::mt19937_64 bits_{1};
};

/// 64 triangles on a sheet, flat or bent: eight runs.
LatticeMesh sheet(Random& random, double size, double far, bool bent) {
  const Int3 middle = random.point(far), u = random.point(size), v = random.point(size);
  LatticeMesh out;
  while (out.triangles.size() < 64) {
    const double a = 4 * random.some(), b = 4 * random.some();
    const auto first = static_cast<std::uint32_t>(out.vertices.size());
    for (int corner = 0; corner < 3; ++corner) {
      const double x = a + random.some(), y = b + random.some(), z = bent ? 0.1 * x * y * size : 0;
      Int3 at;
      for (int k = 0; k < 3; ++k)
        at[k] = middle[k] + static_cast<std::int32_t>(std::lround(x * u[k] + y * v[k] + z));
      out.vertices.push_back(at);
    }
    out.triangles.push_back({first, first + 1, first + 2});
    out.flags.push_back(exact::raw_normal(out.corner(first / 3, 0), out.corner(first / 3, 1),
                                          out.corner(first / 3, 2)) == exact::Normal{}
                            ? kTriangleCollapsed
                            : 0);
  }
  return out;
}

/// A point within a step or two of the line through two others: the third corner of a triangle whose normal
/// is rough in doubles.
Int3 sliver(Random& random, const std::array<Vec, 3>& t) {
  const double along = 2 * random.some();
  Int3 out;
  for (std::size_t k = 0; k < 3; ++k)
    out[static_cast<int>(k)] = static_cast<std::int32_t>(std::lround(t[0][k] + along * (t[1][k] - t[0][k])));
  return out + random.point(1);
}

/// From a few steps to the whole lattice apart, of triangles smaller and larger than the runs: no gap is
/// wider than what the nearest points of the triangle and one of the run's are apart, and many are nearly as
/// wide.
TEST(TurnedGaps, AreNoWiderThanWhatATriangleAndARunAreApart) {
  Random random;
  std::size_t apart = 0, tight = 0;
  for (int round = 0; round < 400; ++round) {
    const double size = std::pow(2, 3 + random.below(20)), far = std::min(16 * size, 0x1p27);
    const LatticeMesh mesh = sheet(random, size, far, round % 2 == 0);
    const TriangleTree tree = TriangleTree::make(
        mesh, [] { return true; }, kTriangleCollapsed);
    ASSERT_FALSE(tree.turned.empty());
    for (int asked = 0; asked < 40; ++asked) {
      const double side = size * std::pow(2, random.below(6) - 2.0);
      const Int3 at = random.point(far);
      std::array<Vec, 3> t;
      std::array<double, 9> corners;
      for (std::size_t c = 0; c < 3; ++c) {
        t[c] = vec(c == 2 && asked % 4 == 0 ? sliver(random, t) : at + random.point(side));
        for (std::size_t k = 0; k < 3; ++k) corners[3 * c + k] = t[c][k];
      }
      std::array<double, kLanes> squared;
      turned_gaps(corners, tree.turned[0], squared);
      for (std::size_t run = 0; kLanes * run < tree.order.size(); ++run) {
        double least = std::numeric_limits<double>::infinity();
        for (std::size_t i = kLanes * run; i < std::min(kLanes * (run + 1), tree.order.size()); ++i) {
          std::array<Vec, 3> s;
          for (int c = 0; c < 3; ++c) s[static_cast<std::size_t>(c)] = vec(mesh.corner(tree.order[i], c));
          least = std::min(least, nearest_points(s, t).squared);
        }
        ASSERT_LE(squared[run], least) << "round " << round << ", run " << run;
        apart += squared[run] > 0 ? 1u : 0u;
        tight += squared[run] > 0.9 * least ? 1u : 0u;
      }
    }
  }
  EXPECT_GT(apart, 50'000u);
  EXPECT_GT(tight, apart / 10);
}

/// Eight triangles and one, of a few steps to the whole lattice, some of them slivers.
struct Eight {
  std::array<std::array<std::int32_t, kLanes>, 9> corners;
  std::array<std::array<Vec, 3>, kLanes> s;
  exact::Corners m;
  std::array<Vec, 3> one;
  PairLanes lanes{};

  Eight(Random& random, double size, double far) {
    const auto triangle = [&](bool thin) {
      const Int3 at = random.point(far);
      std::array<Vec, 3> out;
      do {  // none that is collapsed, as no tree holds one
        for (std::size_t c = 0; c < 3; ++c)
          out[c] = vec(c == 2 && thin ? sliver(random, out) : at + random.point(size));
      } while (length(cross(out[1] - out[0], out[2] - out[0])) == 0);
      return out;
    };
    for (std::size_t lane = 0; lane < kLanes; ++lane) {
      s[lane] = triangle(lane == 0);
      for (std::size_t c = 0; c < 3; ++c)
        for (std::size_t k = 0; k < 3; ++k)
          corners[3 * c + k][lane] = static_cast<std::int32_t>(s[lane][c][k]);
    }
    one = triangle(random.below(4) == 0);
    for (std::size_t c = 0; c < 3; ++c)
      for (std::size_t k = 0; k < 3; ++k) m[c][static_cast<int>(k)] = static_cast<std::int32_t>(one[c][k]);
    lanes.s = &corners;
    lanes.take(m);
  }
};

/// The nearest points are on the feature that distances() names.
TEST(Distances, NameTheFeatureThatIsSoNear) {
  Random random;
  std::array<std::size_t, kFeatures> named{};
  for (int round = 0; round < 10'000; ++round) {
    const double size = std::pow(2, 3 + random.below(12));
    const Eight eight(random, size, 3 * size);
    PairDistances found;
    distances(eight.lanes, found);
    for (std::size_t lane = 0; lane < kLanes; ++lane) {
      const auto feature = static_cast<std::size_t>(found.feature[lane]);
      ASSERT_LT(feature, kFeatures);
      ++named[feature];
      const double distance = std::sqrt(found.squared[lane]),
                   error = distance_error(4 * size, 12 * size) + 0.001;
      EXPECT_NEAR(std::sqrt(nearest_points(eight.s[lane], eight.one, feature).squared), distance, error);
      EXPECT_NEAR(std::sqrt(nearest_points(eight.s[lane], eight.one).squared), distance, error);
    }
  }
  for (const std::size_t count : named) EXPECT_GT(count, 100u);
}

/// What lies on one side of another's plane at every moment is told apart, and nothing else: corners that go
/// straight on are followed, and what may turn besides is a way in any direction.
TEST(MayMeet, NeverLeavesOutWhatComesToThePlane) {
  Random random;
  std::size_t left_out = 0, asked = 0;
  for (int round = 0; round < 20'000; ++round) {
    const double size = std::pow(2, 3 + random.below(20)), far = std::min(3 * size, 0x1p28);
    const Eight eight(random, size, far);
    PairMotion motion{{}, std::pow(2, -static_cast<double>(random.below(6))), 0, 1};
    if (random.below(2) == 0) motion.turns = 0.1 * size * std::abs(random.some());
    for (auto& speed : motion.speeds)
      for (double& v : speed) v = 2 * size * random.some();
    const unsigned may = may_meet(eight.lanes, motion);
    for (std::size_t lane = 0; lane < kLanes; ++lane) {
      const std::array<Vec, 3>& s = eight.s[lane];
      const Vec n = cross(s[1] - s[0], s[2] - s[0]);
      const double length_of_n = length(n);
      ++asked;
      if ((may >> lane & 1) != 0) continue;
      ++left_out;
      // What it is apart along the normal, which of a sliver is rough, at the beginning and at the end.
      double before = std::numeric_limits<double>::infinity(), behind = before, low = before, high = before;
      for (std::size_t c = 0; c < 3; ++c) {
        const double own = dot(n, s[c] - s[0]) / length_of_n,
                     other = dot(n, eight.one[c] - s[0]) / length_of_n,
                     turned = motion.time * dot(n, motion.speeds[c]) / length_of_n;
        low = std::min(low, own);
        high = std::min(high, -own);
        // A way that turns with the square of time is longest at the end, or never begins.
        before = std::min(before, other - std::max(motion.turns - turned, 0.0));
        behind = std::min(behind, -other - std::max(motion.turns + turned, 0.0));
      }
      EXPECT_TRUE(before + high > 0 || behind + low > 0) << "round " << round << ", lane " << lane;
    }
  }
  EXPECT_GT(left_out, asked / 8);
}

}  // namespace
}  // namespace palpate::native

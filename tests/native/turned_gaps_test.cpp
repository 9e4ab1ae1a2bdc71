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

}  // namespace
}  // namespace palpate::native

#pragma once
#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <random>
#include <vector>

#include "shaders/shared/frame.h"
#include "tests/compute/geometry_cases.h"
#include "tests/compute/shaders/probe_frame.h"
#include "tests/compute/shaders/probe_geometry.h"
#include "tests/compute/shaders/probe_sums.h"
#include "tests/compute/shaders/probe_triangle_voxel.h"
#include "tests/compute/shaders/probe_wide_integer.h"

/// What the tests of shaders/lib ask of the device, one function a probe. The same every time: tests/mutation
/// asks mutants the same.
namespace palpate::probe_cases {

inline bool flat(const Int3 (&t)[3]) { return LatticePoints::normal(t) == Long3(0); }

inline std::vector<gpu::PairCase> pairs() {
  LatticePoints points(1);
  std::vector<gpu::PairCase> cases(40000);
  for (std::size_t i = 0; i < cases.size(); ++i) {
    auto& c = cases[i];
    points.choose();
    points.triangle(c.s);
    points.triangle(c.t);
    if (i % 5 == 0) {  // in one plane z = const
      for (int k = 0; k < 3; ++k) c.s[k].z = c.t[k].z = c.s[0].z;
    } else if (i % 7 == 0) {
      c.t[0] = c.s[2];  // a common corner
    }
    if (flat(c.s)) points.triangle(c.s);
    if (flat(c.t)) points.triangle(c.t);
  }
  return cases;
}

/// The largest component in [2^28, 2^29), as a direction of a contact has it; d ≠ 0.
inline Int3 as_direction(Int3 d) {
  while (std::max({std::abs(d.x), std::abs(d.y), std::abs(d.z)}) < 1 << 28) d *= 2;
  while (std::max({std::abs(d.x), std::abs(d.y), std::abs(d.z)}) >= 1 << 29) d /= 2;
  return d;
}

inline std::vector<gpu::RayCase> rays() {
  LatticePoints points(2);
  std::vector<gpu::RayCase> cases(20000);
  for (std::size_t i = 0; i < cases.size(); ++i) {
    auto& c = cases[i];
    points.choose();
    points.triangle(c.corner);
    c.point = points.point();
    do {
      // Towards a point of the triangle or of its plane half of the time, so that many cross, also through
      // corners and edges.
      const Int3 at = i % 2 == 0   ? points.point()
                      : i % 4 == 1 ? c.corner[0]
                                   : (c.corner[0] + c.corner[1]) / 2;
      c.direction = at - c.point;
      if (i % 16 == 3) c.direction = {i % 32 == 3 ? 1 << 28 : 0, 0, -(1 << 28)};
      if (i % 11 == 0) c.point = c.corner[2];
    } while (c.direction == Int3(0) && (c.point = points.point(), true));
    c.direction = as_direction(c.direction);
  }
  return cases;
}

/// Where `normals` is given, it gets the triangles' raw normals.
inline std::vector<gpu::SampleCase> samples(std::vector<Long3>* normals_out = nullptr) {
  LatticePoints points(3);
  std::vector<gpu::SampleCase> cases(40000);
  std::vector<Long3> normals(cases.size());
  for (std::size_t i = 0; i < cases.size(); ++i) {
    auto& c = cases[i];
    points.choose();
    points.triangle(c.corner);
    const Long3 n = normals[i] = LatticePoints::normal(c.corner);
    c.axis = std::abs(n.y) > std::abs(n.x) ? 1 : 0;
    if (std::abs(n.z) > std::abs(n[c.axis])) c.axis = 2;
    const int u = (c.axis + 1) % 3, v = (c.axis + 2) % 3;
    // In the triangle's box, as the frame asks; often at a corner or on an edge.
    const auto pick = [&](int k) {
      const auto [low, high] = std::minmax({c.corner[0][k], c.corner[1][k], c.corner[2][k]});
      return i % 3 == 0 ? c.corner[i % 2][k]
                        : low + static_cast<int>((static_cast<std::int64_t>(high) - low) *
                                                 (points.within(500) + 500) / 1000);
    };
    c.u = pick(u);
    c.v = pick(v);
  }
  if (normals_out != nullptr) *normals_out = std::move(normals);
  return cases;
}

class Boxes {
 public:
  /// Corners on a coarse lattice round a box of `half` steps: faces, edges and corners are hit exactly all
  /// the time.
  gpu::BoxCase coarse(int half) {
    const auto at = [&] { return static_cast<int>(engine_() % 9) * half / 2 - 2 * half; };
    return with_box({at(), at(), at()}, {at(), at(), at()}, {at(), at(), at()}, Int3(0), half);
  }
  /// Anywhere within ±2^28, box too; corners often at the bound.
  gpu::BoxCase large() {
    std::uniform_int_distribution<int> far(-(1 << 28), 1 << 28), size(4, 1 << 27);
    const auto at = [&] {
      const auto pick = engine_() % 6;
      return pick == 0 ? -(1 << 28) : pick == 1 ? 1 << 28 : far(engine_);
    };
    const int half = size(engine_);
    std::uniform_int_distribution<int> centre(-(1 << 28) + half, (1 << 28) - half);
    return with_box({at(), at(), at()}, {at(), at(), at()}, {at(), at(), at()},
                    {centre(engine_), centre(engine_), centre(engine_)}, half);
  }
  /// A large triangle whose plane passes within a step or two of a corner of the box: the 92-bit comparison
  /// decides.
  gpu::BoxCase grazing() {
    gpu::BoxCase c = large();
    const Int3 corner{engine_() % 2 ? c.lo.x : c.hi.x, engine_() % 2 ? c.lo.y : c.hi.y,
                      engine_() % 2 ? c.lo.z : c.hi.z};
    const auto near = [&] { return static_cast<int>(engine_() % 3) - 1; };
    // c on the far side of the corner from a, twice as far or less, clipped to the lattice: the side a–c
    // passes the corner.
    c.c = glm::clamp(2 * corner - c.a, Int3(-(1 << 28)), Int3(1 << 28));
    c.c = glm::clamp(c.c + Int3(near(), near(), near()), Int3(-(1 << 28)), Int3(1 << 28));
    return c;
  }

 private:
  static gpu::BoxCase with_box(Int3 a, Int3 b, Int3 c, Int3 centre, int half) {
    return {a, b, c, centre - half, centre + half};
  }
  std::mt19937_64 engine_{7};
};

inline std::vector<gpu::BoxCase> boxes() {
  Boxes source;
  std::vector<gpu::BoxCase> cases;
  for (int i = 0; i < 20000; ++i) {
    for (const auto& c : {source.coarse(2), source.coarse(1 << 20), source.large(), source.grazing()}) {
      if (!flat({c.a, c.b, c.c})) cases.push_back(c);
    }
  }
  return cases;
}

/// Mostly random; often small, zero or at a bound, where the mistakes are.
class Numbers {
 public:
  std::int64_t within(std::int64_t bound) {
    switch (engine_() % 8) {
      case 0:
        return 0;
      case 1:
        return bound;
      case 2:
        return -bound;
      case 3:
        return static_cast<std::int64_t>(engine_() % 5) - 2;
      default:
        return std::uniform_int_distribution<std::int64_t>(-bound, bound)(engine_);
    }
  }
  glm::ivec3 point(std::int64_t bound) {
    return {static_cast<int>(within(bound)), static_cast<int>(within(bound)),
            static_cast<int>(within(bound))};
  }

 private:
  std::mt19937_64 engine_{1};
};

inline std::vector<gpu::WideCase> wide() {
  Numbers numbers;
  std::vector<gpu::WideCase> cases(20000);
  for (auto& c : cases) {
    for (auto& n : c.n) n = numbers.within((std::int64_t{1} << 60) + (std::int64_t{1} << 57));  // ≥ 2^60.2
    c.d = numbers.point((1 << 29) + 1);
    c.e = numbers.point((1 << 29) + 1);
    c.a = numbers.point(1 << 28);
    c.b = numbers.point(1 << 28);
    c.c = numbers.point(1 << 28);
  }
  return cases;
}

/// Triangles and segments from `point` to `direction`, often with an end on a corner, an edge's middle or the
/// plane.
inline std::vector<gpu::RayCase> segments() {
  LatticePoints points(5);
  std::vector<gpu::RayCase> cases(40000);
  for (std::size_t i = 0; i < cases.size(); ++i) {
    auto& c = cases[i];
    do {
      points.choose();
      points.triangle(c.corner);
      c.point = points.point();
      c.direction = points.point();
      if (i % 5 == 0) c.point = c.corner[i % 3];
      if (i % 7 == 0) c.direction = (c.corner[i % 3] + c.corner[(i + 1) % 3]) / 2;
      if (i % 11 == 0) c.direction.x = c.point.x;
      if (i % 33 == 0) c.direction.y = c.point.y;
    } while (c.direction == c.point);
  }
  return cases;
}

/// Triangles and points anywhere on the lattice: at corners, on edges, above the inside, and far away.
inline std::vector<gpu::DistanceCase> distances() {
  LatticePoints points(12);
  std::vector<gpu::DistanceCase> cases(60000);
  for (std::size_t i = 0; i < cases.size(); ++i) {
    auto& c = cases[i];
    do {
      points.choose();
      points.triangle(c.corner);
    } while (flat(c.corner));
    const Long3 n = LatticePoints::normal(c.corner);
    const double x = static_cast<double>(n.x), y = static_cast<double>(n.y), z = static_cast<double>(n.z),
                 scale = 0x1p30 / std::sqrt(x * x + y * y + z * z);
    c.normal = {static_cast<int>(std::lround(x * scale)), static_cast<int>(std::lround(y * scale)),
                static_cast<int>(std::lround(z * scale))};
    c.point = points.point();
    if (i % 5 == 0) c.point = c.corner[i % 3];
    if (i % 7 == 0) c.point = (c.corner[i % 3] + c.corner[(i + 1) % 3]) / 2;
    if (i % 3 == 0)
      c.point = (c.corner[0] + c.corner[1] + c.corner[2]) / 3 +
                Int3(points.within(100), points.within(100), points.within(100));
  }
  return cases;
}

/// Points of grids of every size: on faces and a step beside them, within and beyond.
inline std::vector<gpu::CellCase> cells() {
  std::mt19937_64 engine(8);
  std::vector<gpu::CellCase> cases(40000);
  for (std::size_t i = 0; i < cases.size(); ++i) {
    auto& c = cases[i];
    c.side = 2 + static_cast<int>(engine() % (std::uint64_t{1} << (1 + i % 16)));
    const int most = std::min(1 << 15, (1 << 30) / c.side);
    for (int k = 0; k < 3; ++k) {
      c.n[k] =
          1 + static_cast<int>(engine() % static_cast<std::uint64_t>(std::min(most, 1 << (1 + i / 16 % 10))));
      if (i % 8 == 0 && k == 0) c.n[k] = most;
      const auto cell = static_cast<int>(engine() % static_cast<std::uint64_t>(c.n[k] + 3)) - 1;
      c.d[k] = cell * c.side + (i % 2 == 0 ? static_cast<int>(engine() % 3) - 1
                                           : static_cast<int>(engine() % static_cast<std::uint64_t>(c.side)));
    }
  }
  return cases;
}

/// Sums of normals of every size.
inline std::vector<gpu::DirectionCase> directions() {
  LatticePoints points(6);
  std::vector<gpu::DirectionCase> cases(30000);
  for (std::size_t i = 0; i < cases.size(); ++i) {
    auto& c = cases[i];
    const auto places = static_cast<int>(i % 60);
    for (std::int64_t& component : c.sum)
      component = points.within(1 << 28) * (std::int64_t{1} << 31) >> places;
    if (i % 5 == 0) c.sum[i % 3] = (std::int64_t{1} << places) * (i % 2 == 0 ? 1 : -1);
    if (i % 101 == 0) c = {{0, 0, 0}};
  }
  return cases;
}

/// Points up to 2^28 and rotations whose rows are no longer than one.
inline std::vector<gpu::PoseCase> poses() {
  std::mt19937_64 engine(9);
  const auto within = [&](std::int32_t reach) {
    return static_cast<std::int32_t>(engine() % (2 * static_cast<std::uint64_t>(reach) + 1)) - reach;
  };
  std::vector<gpu::PoseCase> cases(10000);
  for (std::size_t i = 0; i < cases.size(); ++i) {
    auto& c = cases[i];
    const std::int32_t reach = 1 << (1 + i % 28);
    for (int k = 0; k < 3; ++k) {
      c.point[k] = within(reach);
      c.translation[k] = within(1 << 28);
      for (int j = 0; j < 3; ++j)
        c.rotation_q30[static_cast<std::size_t>(3 * k + j)] = i % 2 == 0 ? within(600'000'000)
                                                              : (j + k) % 3 == static_cast<int>(i % 3)
                                                                  ? 1 << 30
                                                                  : 0;
    }
  }
  return cases;
}

/// Grids of one to three bricks an axis; points and voxels in them, on their ends, and beside them.
inline std::vector<gpu::PartitionCase> partitions() {
  std::mt19937_64 engine(10);
  std::vector<gpu::PartitionCase> cases(20000);
  for (auto& c : cases) {
    c.grid = {};
    c.grid.size = 8 << engine() % 8;
    for (int k = 0; k < 3; ++k) {
      c.grid.origin[k] = static_cast<std::int32_t>(engine() % 2001) - 1000;
      c.grid.bricks[k] = 1 + static_cast<std::int32_t>(engine() % 3);
      const std::int32_t voxels = 8 * c.grid.bricks[k];
      const std::uint64_t choice = engine() % 8;
      c.voxel[k] = choice == 0   ? -1
                   : choice == 1 ? voxels
                   : choice == 2 ? 0
                   : choice == 3 ? voxels - 1
                                 : static_cast<std::int32_t>(engine() % static_cast<std::uint64_t>(voxels));
      const auto voxel = static_cast<std::int32_t>(engine() % static_cast<std::uint64_t>(voxels + 4)) - 2;
      c.point[k] = c.grid.origin[k] + voxel * c.grid.size +
                   (engine() % 2 == 0 ? static_cast<std::int32_t>(engine() % 3) - 1 : c.grid.size / 2);
    }
  }
  return cases;
}

/// Numbers of workgroups: few, round every multiple of a row, and any.
inline std::vector<std::uint32_t> groups() {
  std::mt19937_64 engine(11);
  std::vector<std::uint32_t> cases;
  for (std::uint32_t n = 0; n < 100; ++n) cases.push_back(n);
  for (std::uint32_t rows = 1; rows < 65535; rows += rows < 20 ? 1 : rows / 3)
    for (const std::uint32_t n :
         {rows * gpu::kMaxGroupsX - 1, rows * gpu::kMaxGroupsX, rows * gpu::kMaxGroupsX + 1})
      cases.push_back(n);
  for (int i = 0; i < 1000; ++i)
    cases.push_back(static_cast<std::uint32_t>(engine() % (std::uint64_t{1} << (1 + i % 32))) & 0xFFFF0000u);
  return cases;
}

}  // namespace palpate::probe_cases

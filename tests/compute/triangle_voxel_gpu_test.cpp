#include <algorithm>
#include <random>

#include "cpu_ref/triangle_cube.h"
#include "tests/compute/code.h"
#include "tests/compute/gpu_test.h"
#include "tests/compute/shaders/probe_triangle_voxel.h"

namespace palpate {
namespace {

using TriangleVoxel = GpuTest;

class Cases {
 public:
  /// Corners on a coarse lattice round a box of `half` steps: faces, edges and corners are hit exactly all the time.
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
  /// A large triangle whose plane passes within a step or two of a corner of the box: the 92-bit comparison decides.
  gpu::BoxCase grazing() {
    gpu::BoxCase c = large();
    const Int3 corner{engine_() % 2 ? c.lo.x : c.hi.x, engine_() % 2 ? c.lo.y : c.hi.y, engine_() % 2 ? c.lo.z : c.hi.z};
    const auto near = [&] { return static_cast<int>(engine_() % 3) - 1; };
    // c on the far side of the corner from a, twice as far or less, clipped to the lattice: the side a–c passes the corner.
    c.c = glm::clamp(2 * corner - c.a, Int3(-(1 << 28)), Int3(1 << 28));
    c.c = glm::clamp(c.c + Int3(near(), near(), near()), Int3(-(1 << 28)), Int3(1 << 28));
    return c;
  }

 private:
  static gpu::BoxCase with_box(Int3 a, Int3 b, Int3 c, Int3 centre, int half) { return {a, b, c, centre - half, centre + half}; }
  std::mt19937_64 engine_{7};
};

TEST_F(TriangleVoxel, AgreesWithClippingEdgesInFractions) {
  Cases source;
  std::vector<gpu::BoxCase> cases;
  for (int i = 0; i < 20000; ++i) {
    for (const auto& c : {source.coarse(2), source.coarse(1 << 20), source.large(), source.grazing()}) {
      const cpu_ref::Triangle t(c.a, c.b, c.c);
      if (t.normal != Long3(0)) cases.push_back(c);
    }
  }
  const auto answers = run_probe<std::int32_t>(spirv::probe_triangle_voxel, cases);
  int touching = 0;
  for (std::size_t i = 0; i < cases.size(); ++i) {
    const auto& c = cases[i];
    cpu_ref::Box box;
    box.min = c.lo;
    box.max = c.hi;
    const bool want = cpu_ref::triangle_meets_box(cpu_ref::Triangle(c.a, c.b, c.c), box);
    ASSERT_EQ(answers[i] != 0, want) << "case " << i;
    touching += want;
  }
  // Both answers were asked for often enough to mean something.
  EXPECT_GT(touching, static_cast<int>(cases.size() / 10));
  EXPECT_LT(touching, static_cast<int>(cases.size() - cases.size() / 10));
}

}  // namespace
}  // namespace palpate

#include <random>

#include "tests/compute/code.h"
#include "tests/compute/gpu_test.h"
#include "tests/compute/shaders/probe_wide_integer.h"

namespace palpate {
namespace {

__extension__ using I128 = __int128;
using WideInteger = GpuTest;

I128 wide(std::int64_t high, std::uint64_t low) { return (static_cast<I128>(high) << 64) + static_cast<I128>(low); }
int sign(I128 v) { return v < 0 ? -1 : v > 0; }

/// Mostly random; often small, zero or at a bound, where the mistakes are.
class Numbers {
 public:
  std::int64_t within(std::int64_t bound) {
    switch (engine_() % 8) {
      case 0: return 0;
      case 1: return bound;
      case 2: return -bound;
      case 3: return static_cast<std::int64_t>(engine_() % 5) - 2;
      default: return std::uniform_int_distribution<std::int64_t>(-bound, bound)(engine_);
    }
  }
  glm::ivec3 point(std::int64_t bound) {
    return {static_cast<int>(within(bound)), static_cast<int>(within(bound)), static_cast<int>(within(bound))};
  }

 private:
  std::mt19937_64 engine_{1};
};

TEST_F(WideInteger, AgreesWithTheCompilersOwn128Bits) {
  Numbers numbers;
  std::vector<gpu::WideCase> cases(20000);
  for (auto& c : cases) {
    for (auto& n : c.n) n = numbers.within((std::int64_t{1} << 60) + (std::int64_t{1} << 57));   // ≥ 2^60.2
    c.x = numbers.within(INT64_MAX);
    c.y = numbers.within(std::int64_t{1} << 61);
    c.d = numbers.point((1 << 29) + 1);
    c.a = numbers.point(1 << 28);
    c.b = numbers.point(1 << 28);
    c.c = numbers.point(1 << 28);
  }
  const auto answers = run_probe<gpu::WideAnswer>(spirv::probe_wide_integer, cases);
  for (std::size_t i = 0; i < cases.size(); ++i) {
    const auto& c = cases[i];
    const auto& a = answers[i];
    SCOPED_TRACE(i);
    I128 dot = 0;
    for (int k = 0; k < 3; ++k) dot += static_cast<I128>(c.n[k]) * c.d[k];
    const I128 product = static_cast<I128>(c.x) * c.y;
    ASSERT_EQ(a.sign_, sign(dot));
    ASSERT_EQ(a.wide_sign, sign(dot));
    ASSERT_TRUE(wide(a.dot_high, a.dot_low) == dot);
    ASSERT_TRUE(wide(a.product_high, a.product_low) == product);
    ASSERT_TRUE(wide(a.sum_high, a.sum_low) == dot + product);
    ASSERT_TRUE(wide(a.difference_high, a.difference_low) == dot - product);
    ASSERT_EQ(a.less, dot < product);
    const glm::i64vec3 u = glm::i64vec3(c.b) - glm::i64vec3(c.a), v = glm::i64vec3(c.c) - glm::i64vec3(c.a);
    ASSERT_EQ(a.normal[0], u.y * v.z - u.z * v.y);
    ASSERT_EQ(a.normal[1], u.z * v.x - u.x * v.z);
    ASSERT_EQ(a.normal[2], u.x * v.y - u.y * v.x);
    const I128 top = dot < 0 ? -dot : dot;
    const I128 bottom = top + static_cast<I128>(static_cast<std::uint64_t>(c.x) >> 2) + 1;
    ASSERT_TRUE(static_cast<I128>(a.ratio) == (top << 30) / bottom);
    ASSERT_TRUE(static_cast<I128>(a.ratio_two) == (top << 31) / bottom);
  }
}

}  // namespace
}  // namespace palpate

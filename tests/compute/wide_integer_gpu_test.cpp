#include "tests/compute/code.h"
#include "tests/compute/gpu_test.h"
#include "tests/compute/probe_cases.h"

namespace palpate {
namespace {

__extension__ using I128 = __int128;
using WideInteger = GpuTest;

I128 wide(std::int64_t high, std::uint64_t low) { return (static_cast<I128>(high) << 64) + static_cast<I128>(low); }
int sign(I128 v) { return v < 0 ? -1 : v > 0; }

TEST_F(WideInteger, AgreesWithTheCompilersOwn128Bits) {
  const auto cases = probe_cases::wide();
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

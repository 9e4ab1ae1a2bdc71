#include "tests/compute/code.h"
#include "tests/compute/gpu_test.h"
#include "tests/compute/probe_cases.h"

namespace palpate {
namespace {

__extension__ using I128 = __int128;
using WideInteger = GpuTest;

I128 value(std::int64_t high, std::int64_t low) { return static_cast<I128>(high) * (1 << 30) + low; }
int sign(I128 v) { return v < 0 ? -1 : v > 0; }

TEST_F(WideInteger, AgreesWithTheCompilersOwn128Bits) {
  const auto cases = probe_cases::wide();
  const auto answers = run_probe<gpu::WideAnswer>(spirv::probe_wide_integer, cases);
  for (std::size_t i = 0; i < cases.size(); ++i) {
    const auto& c = cases[i];
    const auto& a = answers[i];
    SCOPED_TRACE(i);
    I128 dot = 0, other = 0;
    for (int k = 0; k < 3; ++k) dot += static_cast<I128>(c.n[k]) * c.d[k];
    for (int k = 0; k < 3; ++k) other += static_cast<I128>(c.n[k]) * c.e[k];
    ASSERT_EQ(a.sign_, sign(dot));
    ASSERT_EQ(a.negated_sign, -sign(dot));
    ASSERT_EQ(a.is_zero, dot == 0 ? 1 : 0);
    ASSERT_EQ(a.number_sign, sign(c.n[0]));
    ASSERT_TRUE(value(a.dot_high, a.dot_low) == dot);
    ASSERT_TRUE(value(a.sum_high, a.sum_low) == dot + other);
    ASSERT_TRUE(value(a.difference_high, a.difference_low) == dot - other);
    const glm::i64vec3 u = glm::i64vec3(c.b) - glm::i64vec3(c.a), v = glm::i64vec3(c.c) - glm::i64vec3(c.a);
    ASSERT_EQ(a.normal[0], u.y * v.z - u.z * v.y);
    ASSERT_EQ(a.normal[1], u.z * v.x - u.x * v.z);
    ASSERT_EQ(a.normal[2], u.x * v.y - u.y * v.x);
  }
}

}  // namespace
}  // namespace palpate

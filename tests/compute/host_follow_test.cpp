#include <gtest/gtest.h>

#include <set>

#include "cpu_ref/ray.h"
#include "tests/compute/follow_cases.h"

namespace palpate {
namespace {

/// docs/EXACTNESS.md section 7 word by word: of each sample, the areas of the first crossings below its height.
std::set<std::pair<std::uint32_t, std::uint32_t>> by_definition(const follow_cases::Contact& c) {
  std::set<std::pair<std::uint32_t, std::uint32_t>> out;
  for (const RisenSample& sample : c.risen) {
    std::uint32_t first = sample.height;
    std::set<std::uint32_t> there;
    for (const gpu::StaticResult& s : c.statics) {
      if (s.area == sample.area) continue;
      const LatticeMesh& mesh = c.geometry.mockup;
      const auto crossing = cpu_ref::ray_crosses_at(sample.point, -Int3(c.areas[sample.area].direction), {mesh.corner(s.id, 0), mesh.corner(s.id, 1), mesh.corner(s.id, 2)});
      if (!crossing || crossing->sign < 0 || crossing->height >= sample.height || crossing->height > first) continue;
      if (crossing->height < first) there.clear();
      first = crossing->height;
      there.insert(s.area);
    }
    for (const std::uint32_t area : there) out.emplace(sample.area, area);
  }
  return out;
}

TEST(HostFollow, PiercesWhatRaysLeaveFirst) {
  std::size_t pierced = 0, not_pierced = 0;
  for (const auto& contact : follow_cases::contacts()) {
    const auto expected = by_definition(*contact);
    std::set<std::pair<std::uint32_t, std::uint32_t>> answer;
    for (const gpu::AreaPierce& p : follow_cases::pierces(*contact)) EXPECT_TRUE(answer.emplace(p.area, p.pierced).second) << "each pair once";
    ASSERT_EQ(answer, expected);
    pierced += expected.size();
    not_pierced += contact->areas.size() * (contact->areas.size() - 1) - expected.size();
  }
  EXPECT_GT(pierced, 1000u);
  EXPECT_GT(not_pierced, 1000u);
}

}  // namespace
}  // namespace palpate

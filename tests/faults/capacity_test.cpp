// Every list and table of a frame, made far too small: the answer says which, nothing is silently cut, and
// with more room it is the reference's.
#include <gmock/gmock.h>

#include <algorithm>
#include <set>
#include <utility>

#include "compute/gpu/frame/capacity.h"
#include "tests/faults/fault_scene.h"

namespace palpate {
namespace {

using testing::HasSubstr;

std::unique_ptr<CollisionBackend> gpu(const std::map<std::string, std::uint32_t>& first_capacity) {
  GpuOptions options;
  options.validation = true;
  options.guard_buffers = true;  // a write behind a list that is full is an error
  options.first_capacity = first_capacity;
  auto made = make_gpu_backend(options);
  if (!made) throw std::runtime_error(made.error().sentence);
  return std::move(*made);
}

/// A list's name, and which scene fills it with more than one item.
struct Small {
  const char* list;
  std::unique_ptr<FaultScene> (*scene)();
};
void PrintTo(const Small& small, std::ostream* out) { *out << small.list; }

class Capacity : public testing::TestWithParam<Small> {};
INSTANTIATE_TEST_SUITE_P(
    Each, Capacity,
    testing::Values(Small{"near parts of the tool", ball_on_edge}, Small{"touched voxels", ball_on_edge},
                    Small{"lists of touched voxels", ball_on_edge}, Small{"pairs to test", ball_on_edge},
                    Small{"pairs", ball_on_edge}, Small{"contact triangles of the mock-up", ball_on_edge},
                    Small{"contact triangles of the tool", ball_on_edge},
                    Small{"lists with samples", ball_on_edge},
                    Small{"samples near the tool's surface", ball_on_edge}, Small{"samples", ball_on_edge},
                    Small{"tiles of tool samples", ball_on_edge}, Small{"samples of the tool", ball_on_edge}),
    [](const auto& tested) {
      std::string name = tested.param.list;
      std::erase_if(name, [](char c) { return c == '\'' || c == '-'; });
      std::replace(name.begin(), name.end(), ' ', '_');
      return name;
    });

TEST_P(Capacity, TooSmallIsToldByNameAndGrowsToTheReferencesAnswer) {
  const auto scene = GetParam().scene();
  const auto backend = gpu({{GetParam().list, 1}});
  const auto prepared = prepare(*backend, *scene);
  ASSERT_TRUE(prepared) << prepared.error().sentence;
  Contacts out;
  auto answered = backend->query(scene->pose, nullptr, out);
  ASSERT_TRUE(answered) << answered.error().sentence;
  ASSERT_TRUE(out.truncated);
  EXPECT_STREQ(out.truncated_capacity, GetParam().list);
  EXPECT_TRUE(out.areas.empty()) << "no area, so no force";

  // What overflowed leaves nothing behind: a pose without contact, then the same one again, still truncated.
  answered = backend->query(at(*scene, Vec3(0, 0, 0.05)), nullptr, out);
  ASSERT_TRUE(answered) << answered.error().sentence;
  EXPECT_FALSE(out.truncated);
  EXPECT_FALSE(out.contact);
  answered = backend->query(scene->pose, nullptr, out);
  ASSERT_TRUE(answered) << answered.error().sentence;
  ASSERT_TRUE(out.truncated);

  int times = 0;
  for (; out.truncated; ++times) {
    ASSERT_LT(times, 40);
    const auto enlarged = backend->enlarge();
    ASSERT_TRUE(enlarged) << enlarged.error().sentence;
    answered = backend->query(scene->pose, nullptr, out);
    ASSERT_TRUE(answered) << answered.error().sentence;
  }
  EXPECT_EQ(first_difference(out, scene->expected), "") << "(gpu, cpu)";
  EXPECT_LE(times, 20) << "room at least doubles";
}

/// What the reference's answer needs of the lists whose counts it tells.
std::map<std::string, std::uint32_t> exact_needs(const Contacts& expected) {
  std::set<std::uint32_t> statics;
  for (const auto* ids : {&expected.cst, &expected.bst, &expected.est})
    statics.insert(ids->begin(), ids->end());
  return {{"pairs", static_cast<std::uint32_t>(expected.pairs)},
          {"contact triangles of the mock-up", static_cast<std::uint32_t>(statics.size())},
          {"contact triangles of the tool",
           static_cast<std::uint32_t>(expected.cmt.size() + expected.bmt.size() + expected.imt.size())}};
}

TEST(ExactRoom, IsEnoughAndOneLessIsNot) {
  const auto scene = ball_on_edge();
  for (const auto& [list, needed] : exact_needs(scene->expected))
    for (const bool enough : {true, false}) {
      SCOPED_TRACE(list + (enough ? ": enough" : ": one less"));
      ASSERT_GT(needed, 1u);
      const auto backend = gpu({{list, enough ? needed : needed - 1}});
      const auto prepared = prepare(*backend, *scene);
      ASSERT_TRUE(prepared) << prepared.error().sentence;
      Contacts out;
      const auto answered = backend->query(scene->pose, nullptr, out);
      ASSERT_TRUE(answered) << answered.error().sentence;
      EXPECT_EQ(out.truncated, !enough);
      if (enough) {
        EXPECT_EQ(first_difference(out, scene->expected), "");
      } else {
        EXPECT_EQ(out.truncated_capacity, list);
      }
    }
}

// All of them at once: whatever overflows first hides the rest, and each enlargement brings the next to
// light.
TEST(AllLists, TooSmallAtOnceGrowToTheReferencesAnswer) {
  std::map<std::string, std::uint32_t> ones;
  for (std::uint32_t list = 0; list_name(list) != nullptr; ++list)
    if (*list_name(list) != 0) ones[list_name(list)] = 1;
  for (const auto& make : {ball_on_edge, needle_in_block, ball_in_plate}) {
    const auto scene = make();
    const auto backend = gpu(ones);
    ASSERT_TRUE(prepare(*backend, *scene));
    Contacts out;
    ASSERT_TRUE(backend->query(scene->pose, nullptr, out));
    ASSERT_TRUE(out.truncated) << scene->name;
    for (int times = 0; out.truncated; ++times) {
      ASSERT_LT(times, 100) << scene->name << ": " << out.truncated_capacity;
      const auto enlarged = backend->enlarge();
      ASSERT_TRUE(enlarged) << enlarged.error().sentence;
      ASSERT_TRUE(backend->query(scene->pose, nullptr, out));
    }
    EXPECT_EQ(first_difference(out, scene->expected), "") << scene->name << " (gpu, cpu)";
  }
}

// 17 x 17 posts of 1 mm, 3 mm apart, and a plate on all of them: in `paper` more areas than a frame has, on
// either back end.
TEST(Areas, BeyondTheMostThereCanBeAreTruncatedAndRefusedWithTheLimit) {
  Mesh posts;
  for (int i = -8; i <= 8; ++i)
    for (int j = -8; j <= 8; ++j)
      solids::append(posts,
                     solids::box(Vec3(i, j, 0) * 0.003, Vec3(i, j, 0) * 0.003 + Vec3(0.001, 0.001, 0.003)),
                     "post");
  const auto scene = make_fault_scene(
      "posts", posts, solids::box(Vec3(-0.04, -0.04, 0), Vec3(0.04, 0.04, 0.004)), Vec3(0, 0, 0.0025));
  EXPECT_FALSE(scene->expected.truncated) << "the field has no areas to run out of";
  Plan paper;
  paper.profile = Profile::kPaper;
  const auto reference = make_ref_backend(), backend = gpu({});
  Contacts expected, out;
  for (const auto& [one, answer] : {std::pair{reference.get(), &expected}, std::pair{backend.get(), &out}}) {
    ASSERT_TRUE(one->prepare(scene->geometry, paper, {}));
    ASSERT_TRUE(one->query(scene->pose, nullptr, *answer));
  }
  EXPECT_STREQ(expected.truncated_capacity, "areas");
  EXPECT_EQ(first_difference(out, expected), "");
  const auto enlarged = backend->enlarge();
  ASSERT_FALSE(enlarged);
  EXPECT_THAT(enlarged.error().sentence, HasSubstr("256 contact areas"));
}

}  // namespace
}  // namespace palpate

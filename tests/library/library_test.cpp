// The C interface, as a C program uses it; answers known beforehand from boxes.
#include <gmock/gmock.h>
#include <sys/wait.h>
#include <unistd.h>

#include <atomic>
#include <cmath>
#include <limits>
#include <thread>

#include "tests/library/boxes.h"

namespace palpate {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;

constexpr double kInfinite = std::numeric_limits<double>::infinity();
constexpr double kStep = 1e-6;  // m: far more than a lattice step of scenes of 0.2 m, far less than they tell

TEST(Library, HasTheVersionOfTheProject) { EXPECT_STREQ(palpate_version(), PALPATE_VERSION); }

TEST(Library, TellsTouchFromFree) {
  for (const char* engine : {"cpu", "ref"}) {
    const BoxScene scene(engine);
    EXPECT_STREQ(palpate_scene_engine(scene), engine);
    const std::vector<double> poses = at_heights({0.02, 0.009, -0.01, -0.05});
    std::array<std::uint8_t, 4> touches{9, 9, 9, 9};
    palpate_error* error = nullptr;
    must(palpate_touches(scene, poses.data(), 4, 0, touches.data(), nullptr, &error), error);
    EXPECT_THAT(touches, ElementsAre(0, 1, 1, 0)) << engine;  // the third is wholly inside
  }
}

TEST(Library, ATakenToleranceNeedsAllSamples) {
  const std::vector<double> poses = at_heights({0.0098, 0.005});  // 0.2 mm and 5 mm deep
  std::array<std::uint8_t, 2> touches{9, 9};
  palpate_error* error = nullptr;
  const BoxScene some;
  EXPECT_THAT(sentence_of(palpate_touches(some, poses.data(), 2, 0.001, touches.data(), nullptr, &error),
                          PALPATE_USAGE, error),
              HasSubstr("all samples"));
  const BoxScene all("cpu", true);
  must(palpate_touches(all, poses.data(), 2, 0.001, touches.data(), nullptr, &error), error);
  EXPECT_THAT(touches, ElementsAre(0, 1));
}

TEST(Library, GivesTheColumnsThatAreAskedForAndNoOthers) {
  const BoxScene scene;
  const std::vector<double> poses = at_heights({0.02, 0.009});
  std::array<std::uint8_t, 2> contact{9, 9}, engine{9, 9};
  std::array<std::uint32_t, 2> cst{9, 9}, evaluations{9, 9};
  std::array<double, 2> depth{9, 9};
  std::array<double, 6> force{};
  palpate_columns columns{};
  columns.size = sizeof columns;
  columns.contact = contact.data();
  columns.cst = cst.data();
  columns.depth = depth.data();
  columns.engine = engine.data();
  palpate_error* error = nullptr;
  must(palpate_query(scene, poses.data(), 2, &columns, nullptr, &error), error);
  EXPECT_THAT(contact, ElementsAre(0, 1));
  EXPECT_THAT(cst, ElementsAre(0, 2));  // the two triangles of the plate's top
  EXPECT_EQ(depth[0], 0);
  EXPECT_NEAR(depth[1], 0.001, kStep);
  EXPECT_EQ(engine[1], PALPATE_ENGINE_CPU);
  columns.force = force.data();
  columns.evaluations = evaluations.data();
  must(palpate_query(scene, poses.data(), 2, &columns, nullptr, &error), error);
  EXPECT_EQ(force[2], 0);
  EXPECT_GT(force[5], 0.1);  // upwards, out of the plate
  // Within 3 degrees, as tests/forces asks of faces: samples, 5 and 10 mm apart, are not the same about the
  // middle.
  EXPECT_NEAR(force[3], 0, 0.052 * force[5]);
  EXPECT_GT(evaluations[1], 1u);
}

TEST(Library, AShorterStructOfAnOlderCallerIsEnough) {
  const BoxScene scene;
  const std::vector<double> poses = at_heights({0.009});
  std::uint8_t contact = 9;
  double garbage = 0;
  palpate_columns columns{};
  columns.size = offsetof(palpate_columns, pairs);  // a caller that knows `contact` alone
  columns.contact = &contact;
  columns.force = &garbage;  // beyond its size: whatever lies there is none of it
  palpate_error* error = nullptr;
  must(palpate_query(scene, poses.data(), 1, &columns, nullptr, &error), error);
  EXPECT_EQ(contact, 1);
  EXPECT_EQ(garbage, 0);
}

TEST(Library, AStructThatThisVersionDoesNotKnowIsRefused) {
  const BoxScene scene;
  const std::vector<double> poses = at_heights({0.009});
  std::uint8_t contact = 9;
  struct {
    palpate_columns columns;
    void* newer;
  } later{};
  later.columns.contact = &contact;
  palpate_error* error = nullptr;
  const auto ask = [&] { return palpate_query(scene, poses.data(), 1, &later.columns, nullptr, &error); };
  EXPECT_THAT(sentence_of(ask(), PALPATE_USAGE, error), HasSubstr("the size 0"));
  later.columns.size = sizeof later;
  must(ask(), error);  // not used
  EXPECT_EQ(contact, 1);
  later.newer = &contact;
  EXPECT_THAT(sentence_of(ask(), PALPATE_USAGE, error), HasSubstr("does not know"));
  palpate_watch watch{};
  later.newer = nullptr;
  EXPECT_THAT(sentence_of(palpate_query(scene, poses.data(), 1, &later.columns, &watch, &error),
                          PALPATE_USAGE, error),
              HasSubstr("palpate_watch"));
}

TEST(Library, MeasuresDistances) {
  const BoxScene scene;
  const std::vector<double> poses = at_heights({0.03, 0.009, 0.5});
  std::array<double, 3> distance{};
  std::array<std::uint32_t, 3> of_plate{};
  std::array<double, 9> on_plate{}, on_tool{};
  palpate_distances columns{};
  columns.size = sizeof columns;
  columns.distance = distance.data();
  columns.static_id = of_plate.data();
  columns.on_static = on_plate.data();
  columns.on_mobile = on_tool.data();
  palpate_error* error = nullptr;
  must(palpate_clearance(scene, poses.data(), 3, 0.1, &columns, nullptr, &error), error);
  EXPECT_NEAR(distance[0], 0.02, kStep);
  EXPECT_EQ(distance[1], 0);
  EXPECT_EQ(distance[2], kInfinite);
  EXPECT_NEAR(on_plate[2], 0, kStep);
  EXPECT_NEAR(on_tool[2], 0.02, kStep);
  EXPECT_TRUE(std::isnan(on_plate[3]));
  EXPECT_EQ(of_plate[1], PALPATE_NO_TRIANGLE);
  EXPECT_THAT(sentence_of(palpate_clearance(scene, poses.data(), 3, -1, &columns, nullptr, &error),
                          PALPATE_BAD_VALUE, error),
              HasSubstr("-1 m"));
}

TEST(Library, FindsTheFirstContactOfAMotion) {
  const BoxScene scene;
  const std::vector<double> from = at_heights({0.11, 0.11}), to = at_heights({-0.09, 0.06});
  std::array<std::uint8_t, 2> kind{9, 9};
  std::array<double, 2> time{};
  std::array<double, 14> pose{};
  palpate_motions columns{};
  columns.size = sizeof columns;
  columns.kind = kind.data();
  columns.time = time.data();
  columns.pose = pose.data();
  palpate_error* error = nullptr;
  must(palpate_first_contact(scene, from.data(), to.data(), 2, 0, &columns, nullptr, &error), error);
  EXPECT_THAT(kind, ElementsAre(PALPATE_MOTION_CONTACT, PALPATE_MOTION_CLEAR));
  EXPECT_LE(time[0], 0.5);  // never late
  EXPECT_NEAR(time[0], 0.5, 1e-5);
  EXPECT_NEAR(pose[2], 0.01, 2 * kStep);
  EXPECT_EQ(time[1], 1);
}

TEST(Library, ListsWhatTouches) {
  const BoxScene scene;
  const std::vector<double> poses = at_heights({0.009});
  palpate_contact* contact = nullptr;
  palpate_error* error = nullptr;
  must(palpate_contact_at(scene, poses.data(), &contact, &error), error);
  std::size_t count = 0;
  const std::uint32_t* cst = palpate_contact_list(contact, PALPATE_CST, &count);
  EXPECT_THAT(std::vector(cst, cst + count), ElementsAre(2, 3));
  EXPECT_EQ(palpate_contact_list(contact, 6, &count), nullptr);
  EXPECT_EQ(count, 0u);
  EXPECT_THAT(palpate_contact_json(contact), HasSubstr(R"("parts":{"static":["plate"],"tool":["cube"]})"));
  palpate_contact_free(contact);
}

TEST(Library, SaysWhatIsWrongInOneSentence) {
  palpate_error* error = nullptr;
  palpate_scene* scene = nullptr;
  EXPECT_THAT(sentence_of(palpate_scene_open_file("/nowhere/scene.json", nullptr, &scene, &error),
                          PALPATE_BAD_VALUE, error),
              HasSubstr("/nowhere/scene.json does not exist"));
  EXPECT_EQ(scene, nullptr);
  EXPECT_EQ(palpate_scene_open_file(nullptr, nullptr, &scene, nullptr), PALPATE_USAGE);  // nobody asks why

  palpate_source* source = palpate_source_new();
  EXPECT_THAT(sentence_of(palpate_source_engine(source, "abacus", &error), PALPATE_USAGE, error),
              HasSubstr("abacus"));
  const double vertices[9] = {0, 0, 0, 1, 0, 0, 0, NAN, 0};
  const std::uint32_t faces[3] = {0, 1, 3};
  EXPECT_THAT(
      sentence_of(palpate_source_mesh(source, "m", vertices, 3, faces, 1, &error), PALPATE_BAD_VALUE, error),
      HasSubstr("vertex 2"));
  EXPECT_THAT(
      sentence_of(palpate_source_mesh(source, "m", vertices, 2, faces, 1, &error), PALPATE_BAD_VALUE, error),
      HasSubstr("index 3"));
  must(palpate_source_text(source, "{\"tol\": 1}", "/base", &error), error);
  EXPECT_THAT(sentence_of(palpate_scene_open(source, nullptr, &scene, &error), PALPATE_BAD_VALUE, error),
              HasSubstr("/base/the scene"));
  palpate_source_free(source);
}

TEST(Library, NamesTheBadPose) {
  const BoxScene scene;
  std::vector<double> poses = at_heights(std::vector<double>(100, 0.05));
  poses[7 * 42 + 6] = 0.5;
  std::vector<std::uint8_t> touches(100);
  palpate_error* error = nullptr;
  EXPECT_THAT(sentence_of(palpate_touches(scene, poses.data(), 100, 0, touches.data(), nullptr, &error),
                          PALPATE_BAD_VALUE, error),
              HasSubstr("pose 42 is no pose"));
}

TEST(Library, PaperAnswersNoVerdicts) {
  const BoxScene scene("ref", false, "paper");
  const std::vector<double> poses = at_heights({0.05});
  std::uint8_t touches = 9;
  palpate_error* error = nullptr;
  EXPECT_THAT(sentence_of(palpate_touches(scene, poses.data(), 1, 0, &touches, nullptr, &error),
                          PALPATE_USAGE, error),
              HasSubstr("profile paper"));
}

TEST(Library, EqualScenesHaveEqualHashes) {
  const BoxScene one, other("ref"), paper("ref", false, "paper");
  EXPECT_EQ(std::string(palpate_scene_hash(one)).size(), 32u);
  EXPECT_STREQ(palpate_scene_hash(one), palpate_scene_hash(other));
  EXPECT_STRNE(palpate_scene_hash(one), palpate_scene_hash(paper));
}

TEST(Library, GivesTheTrianglesOfBothBodies) {
  const BoxScene scene;
  EXPECT_EQ(palpate_scene_triangle_count(scene, PALPATE_MOBILE), 12u);
  EXPECT_EQ(palpate_scene_triangle_count(scene, 2), 0u);
  std::vector<double> corners(12 * 9);
  palpate_error* error = nullptr;
  must(palpate_scene_triangles(scene, PALPATE_STATIC, corners.data(), &error), error);
  EXPECT_NEAR(corners[0], -0.1, kStep);
  EXPECT_NEAR(corners[2], -0.02, kStep);
}

// ---- cancelling -------------------------------------------------------------------------------------------

std::int32_t stop_at_half(void* context, const char*, double done) {
  ++*static_cast<int*>(context);
  return done >= 0.5;
}

TEST(Library, TheCallerEndsABatch) {
  const BoxScene scene;
  const std::vector<double> poses = at_heights(std::vector<double>(20'000, 0.009));
  std::vector<std::uint8_t> contact(20'000);
  palpate_columns columns{};
  columns.size = sizeof columns;
  columns.contact = contact.data();
  int told = 0;
  palpate_watch watch{};
  watch.size = sizeof watch;
  watch.progress = stop_at_half;
  watch.context = &told;
  palpate_error* error = nullptr;
  EXPECT_THAT(sentence_of(palpate_query(scene, poses.data(), 20'000, &columns, &watch, &error),
                          PALPATE_CANCELLED, error),
              HasSubstr("cancelled"));
  EXPECT_GT(told, 1);
  EXPECT_EQ(std::count(contact.begin() + 18'000, contact.end(), 1), 0);  // it did end
}

TEST(Library, AFlagOfAnotherThreadEndsABatch) {
  const BoxScene scene;
  const std::size_t count = 1'000'000;
  const std::vector<double> poses = at_heights(std::vector<double>(count, 0.009));
  std::vector<std::uint8_t> contact(count);
  palpate_columns columns{};
  columns.size = sizeof columns;
  columns.contact = contact.data();
  volatile std::int32_t cancel = 0;
  palpate_watch watch{};
  watch.size = sizeof watch;
  watch.cancel = &cancel;
  palpate_error* error = nullptr;
  std::thread other([&] {
    while (__atomic_load_n(contact.data() + 64, __ATOMIC_RELAXED) == 0) std::this_thread::yield();
    __atomic_store_n(&cancel, 1, __ATOMIC_RELAXED);
  });
  (void)sentence_of(palpate_query(scene, poses.data(), count, &columns, &watch, &error), PALPATE_CANCELLED,
                    error);
  other.join();
  EXPECT_EQ(contact.back(), 0);
}

TEST(Library, OpeningCanBeCancelled) {
  const std::int32_t cancel = 1;
  palpate_watch watch{};
  watch.size = sizeof watch;
  watch.cancel = &cancel;
  palpate_source* source = palpate_source_new();
  palpate_error* error = nullptr;
  must(palpate_source_text(source, R"({"tool": {"generate": {"name": "contacts", "triangles": 1000}},
    "static": [{"generate": {"name": "contacts", "triangles": 1000}}]})",
                           nullptr, &error),
       error);
  must(palpate_source_engine(source, "cpu", &error), error);
  palpate_scene* scene = nullptr;
  (void)sentence_of(palpate_scene_open(source, &watch, &scene, &error), PALPATE_CANCELLED, error);
  EXPECT_EQ(scene, nullptr);
  palpate_source_free(source);
}

// ---- threads and processes --------------------------------------------------------------------------------

TEST(Library, ThreadsAskOneSceneAndGetWhatOneWouldGet) {
  const BoxScene scene;
  std::vector<double> heights;
  for (int i = 0; i < 400; ++i) heights.push_back(0.02 - 1e-4 * i);
  const std::vector<double> poses = at_heights(heights);
  const auto ask = [&](std::size_t at_once, std::vector<double>& force, std::vector<std::uint8_t>& touches) {
    force.assign(1200, -1);
    touches.assign(400, 9);
    for (std::size_t first = 0; first < 400; first += at_once) {
      palpate_columns columns{};
      columns.size = sizeof columns;
      columns.force = force.data() + 3 * first;
      palpate_error* error = nullptr;
      must(palpate_query(scene, poses.data() + 7 * first, at_once, &columns, nullptr, &error), error);
      must(palpate_touches(scene, poses.data() + 7 * first, at_once, 0, touches.data() + first, nullptr,
                           &error),
           error);
    }
  };
  std::vector<double> force;
  std::vector<std::uint8_t> touches;
  ask(400, force, touches);
  std::vector<std::thread> threads;
  for (const std::size_t at_once : {1u, 1u, 4u, 400u})
    threads.emplace_back([&, at_once] {
      std::vector<double> mine;
      std::vector<std::uint8_t> my_touches;
      ask(at_once, mine, my_touches);
      EXPECT_EQ(mine, force);
      EXPECT_EQ(my_touches, touches);
    });
  for (std::thread& thread : threads) thread.join();
}

TEST(Library, AChildProcessIsRefused) {
  BoxScene scene;
  const std::vector<double> poses = at_heights({0.05});
  std::uint8_t touches = 9;
  const pid_t child = ::fork();
  if (child == 0) {
    palpate_error* error = nullptr;
    const std::int32_t code = palpate_touches(scene, poses.data(), 1, 0, &touches, nullptr, &error);
    const bool said = std::string(palpate_error_sentence(error)).find("after fork()") != std::string::npos;
    palpate_scene_close(scene);  // does nothing, and does not hang
    ::_exit(code == PALPATE_USAGE && said ? 0 : 1);
  }
  int status = -1;
  ASSERT_EQ(::waitpid(child, &status, 0), child);
  EXPECT_EQ(status, 0);
  palpate_error* error = nullptr;
  must(palpate_touches(scene, poses.data(), 1, 0, &touches, nullptr, &error), error);
}

}  // namespace
}  // namespace palpate

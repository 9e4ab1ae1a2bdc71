// Scenes, answers and errors by the thousand give all their memory back.
#include <gtest/gtest.h>
#include <malloc.h>

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <fstream>

#include "tests/library/boxes.h"

namespace palpate {
namespace {

/// What the C library has given out and not got back, bytes.
std::size_t held() {
  const auto known = ::mallinfo2();
  return known.uordblks + known.hblkhd;
}

/// A thing of everything that has to be freed, and of everything that fails.
void live_and_die() {
  const BoxScene scene;
  const std::vector<double> poses = at_heights(std::vector<double>(40, 0.009));
  std::vector<double> force(120), distance(40);
  std::vector<std::uint8_t> touches(40);
  palpate_columns columns{};
  columns.size = sizeof columns;
  columns.force = force.data();
  palpate_distances distances{};
  distances.size = sizeof distances;
  distances.distance = distance.data();
  palpate_error* error = nullptr;
  must(palpate_query(scene, poses.data(), 1, &columns, nullptr, &error), error);
  must(palpate_touches(scene, poses.data(), 40, 0, touches.data(), nullptr, &error), error);
  must(palpate_clearance(scene, poses.data(), 40, 1, &distances, nullptr, &error), error);
  palpate_contact* contact = nullptr;
  must(palpate_contact_at(scene, poses.data(), &contact, &error), error);
  palpate_contact_free(contact);
  palpate_scene* none = nullptr;
  EXPECT_NE(palpate_scene_open_file("/nowhere", nullptr, &none, &error), PALPATE_OK);
  palpate_error_free(error);
}

TEST(Leaks, ScenesGiveTheirMemoryBack) {
  const char* const asked = std::getenv("PALPATE_LEAK_SCENES");
  const int scenes = asked ? std::atoi(asked) : 100;
  for (int i = 0; i < 20; ++i) live_and_die();  // what is made once, and arenas of threads
  // A leak grows in every round; what a busy machine's threads keep for themselves (their arenas, counted as
  // held) does not.
  std::ptrdiff_t least = PTRDIFF_MAX;
  for (int round = 0; round < 3; ++round) {
    const auto before = static_cast<std::ptrdiff_t>(held());
    for (int i = 0; i < scenes; ++i) live_and_die();
    const auto after = static_cast<std::ptrdiff_t>(held());
    std::printf("%d scenes: %td bytes before, %td after\n", scenes, before, after);
    least = std::min(least, after - before);
  }
  // A leak of one byte a scene would not show; one of a vector would: the least is 32 bytes a scene.
  EXPECT_LT(least, 32 * static_cast<std::ptrdiff_t>(scenes));
}

}  // namespace
}  // namespace palpate

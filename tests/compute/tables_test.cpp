#include <gtest/gtest.h>

#include <atomic>
#include <chrono>
#include <map>
#include <random>
#include <thread>
#include <vector>

#include "compute/native/narrow_phase/cell_memo.h"
#include "compute/native/narrow_phase/id_marks.h"
#include "compute/vulkan/compilers.h"

namespace palpate {
namespace {

/// What take_all() tells, in its order.
std::vector<std::pair<std::uint32_t, std::uint32_t>> taken(IdMarks& marks) {
  std::vector<std::pair<std::uint32_t, std::uint32_t>> out;
  marks.take_all([&](std::uint32_t id, std::uint32_t of) { out.emplace_back(id, of); });
  return out;
}

TEST(IdMarks, AnswersAsASortedMapDoes) {
  std::mt19937_64 random(1);
  for (const std::uint32_t ids : {1u, 63u, 64u, 65u, 4096u, 4097u, 100'000u}) {
    IdMarks marks;
    marks.resize(ids);
    for (const std::uint32_t times : {0u, 1u, 10u, 1000u, 7u}) {  // one frame after the other
      std::map<std::uint32_t, std::uint32_t> expected;
      for (std::uint32_t i = 0; i < times; ++i) {
        const auto near = static_cast<std::uint32_t>(random() % ids),
                   id = i % 4 == 0 ? near : static_cast<std::uint32_t>(near % 97 % ids),
                   mark = 1u << random() % 3;
        marks.add(id, mark);
        expected[id] |= mark;
      }
      for (std::uint32_t id = 0; id < ids; ++id) {
        const auto at = expected.find(id);
        ASSERT_EQ(marks.marks(id), at == expected.end() ? 0 : at->second);
      }
      if (times == 10)  // a frame that ends early
        marks.clear();
      else
        ASSERT_EQ(taken(marks),
                  (std::vector<std::pair<std::uint32_t, std::uint32_t>>(expected.begin(), expected.end())));
      for (const auto& [id, mark] : expected) ASSERT_EQ(marks.marks(id), 0u);
      ASSERT_TRUE(taken(marks).empty());
    }
  }
}

TEST(IdMarks, HasRoomForTheLastIdAlone) {
  IdMarks marks;
  marks.resize(12'345);
  marks.add(12'344, 4);
  EXPECT_EQ(marks.marks(12'344), 4u);
  EXPECT_EQ(marks.marks(0), 0u);
  EXPECT_EQ(taken(marks), (std::vector<std::pair<std::uint32_t, std::uint32_t>>{{12'344, 4}}));
}

TEST(CellMemo, NeverTellsAnAnswerOfAnotherCell) {
  std::mt19937_64 random(1);
  CellMemo memo(1000);  // fewer entries than cells: answers displace each other
  std::map<std::pair<std::uint32_t, std::uint32_t>, bool> truth;
  std::size_t found = 0;
  for (int i = 0; i < 100'000; ++i) {
    const std::pair cell(static_cast<std::uint32_t>(random() % 1000),
                         static_cast<std::uint32_t>(random() % 8) * ((1u << CellMemo::kMostPlanes) / 8));
    const bool answer = truth.try_emplace(cell, random() % 2 != 0).first->second;
    if (const std::optional<bool> kept = memo.find(cell.first, cell.second)) {
      ASSERT_EQ(*kept, answer);
      ++found;
    } else {
      memo.keep(cell.first, cell.second, answer);
      ASSERT_EQ(memo.find(cell.first, cell.second), answer);
    }
  }
  EXPECT_GT(found, 5'000u);
  EXPECT_LT(found, 95'000u);
}

TEST(CellMemo, IsEmptyAtFirst) {
  const CellMemo memo(3);
  for (std::uint32_t voxel = 0; voxel < 3; ++voxel)
    for (std::uint32_t sides = 0; sides < 16; ++sides) EXPECT_FALSE(memo.find(voxel, sides));
}

TEST(Compilers, WhatIsHeldWaitsUntilItIsToBegin) {
  std::atomic<int> done{0};
  {
    Compilers compilers;
    compilers.hold();
    for (int i = 0; i < 20; ++i) compilers.add([&] { ++done; });
    std::this_thread::sleep_for(std::chrono::milliseconds(50));
    EXPECT_EQ(done, 0);
    compilers.begin();
    compilers.begin();
    compilers.add([&] { ++done; });  // what follows is not held
    for (int i = 0; i < 1000 && done < 21; ++i) std::this_thread::sleep_for(std::chrono::milliseconds(10));
    EXPECT_EQ(done, 21);
    compilers.hold();
    compilers.add([&] { ++done; });
  }
  EXPECT_EQ(done, 21) << "what was never to begin is dropped";
}

}  // namespace
}  // namespace palpate

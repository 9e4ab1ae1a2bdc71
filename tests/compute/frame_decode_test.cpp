#include <gtest/gtest.h>

#include <algorithm>
#include <memory>
#include <random>
#include <vector>

#include "compute/gpu/frame/decode.h"
#include "model/contact/contacts.h"
#include "shaders/shared/frame.h"
#include "tests/driver/allocation_count.h"

namespace palpate {
namespace {

/// A frame's output: a small area 0 (ids from 10 on) and a large area 1 (ids from 1000 on) of two zones.
struct Output {
  explicit Output(std::uint32_t small = 3, std::uint32_t large = 5000) {
    result->state.contact = 1;
    result->area_count = 2;
    result->areas[0].id = 10;
    result->areas[1].id = 1000;
    for (std::uint32_t i = 0; i < small; ++i) statics.push_back({10 + i, gpu::kStaticHit, 0, 0});
    for (std::uint32_t i = 0; i < large; ++i)
      statics.push_back(
          {1000 + i, i % 2 == 0 ? gpu::kStaticListed : gpu::kStaticSampled, 1, i < large / 2 ? 3u : 4u});
    for (std::uint32_t i = 0; i < 100; ++i)
      mobiles.push_back({i, i % 3 == 0   ? gpu::kMobileHit
                            : i % 3 == 1 ? gpu::kMobileInternal
                                         : gpu::kMobileBoundary});
    for (std::uint32_t i = 0; i < 100; ++i) members.push_back({i % 2, i});
    result->static_count = static_cast<std::uint32_t>(statics.size());
    result->mobile_count = result->member_count = 100;
  }
  /// Lists in any order, as a device leaves them.
  void shuffle() {
    std::mt19937 random(3);
    std::shuffle(statics.begin(), statics.end(), random);
    std::shuffle(mobiles.begin(), mobiles.end(), random);
    std::shuffle(members.begin(), members.end(), random);
  }
  FrameOutput lists() const { return {result.get(), statics.data(), mobiles.data(), members.data()}; }

  std::unique_ptr<gpu::FrameResult> result = std::make_unique<gpu::FrameResult>();
  std::vector<gpu::StaticResult> statics;
  std::vector<gpu::MobileResult> mobiles;
  std::vector<gpu::AreaMember> members;
};

void expect_right(const Contacts& contacts) {
  ASSERT_EQ(contacts.areas.size(), 2u);
  for (const auto* ids :
       {&contacts.cst, &contacts.bst, &contacts.est, &contacts.cmt, &contacts.imt, &contacts.bmt})
    EXPECT_TRUE(std::is_sorted(ids->begin(), ids->end()));
  EXPECT_EQ(contacts.cst, (std::vector<std::uint32_t>{10, 11, 12}));
  EXPECT_EQ(contacts.bst.size(), 2500u);
  EXPECT_EQ(contacts.bst.front(), 1000u);
  EXPECT_EQ(contacts.est.size(), 2500u);
  EXPECT_EQ(contacts.est.front(), 1001u);
  EXPECT_EQ(contacts.cmt.size() + contacts.imt.size() + contacts.bmt.size(), 100u);
  EXPECT_EQ(contacts.imt.front(), 1u);
  EXPECT_EQ(contacts.areas[0].zones, (std::vector<std::vector<std::uint32_t>>{{10, 11, 12}}));
  const ContactArea& large = contacts.areas[1];
  EXPECT_EQ(large.static_ids.size(), 5000u);
  EXPECT_TRUE(std::is_sorted(large.static_ids.begin(), large.static_ids.end()));
  ASSERT_EQ(large.zones.size(), 2u);
  EXPECT_EQ(large.zones[0].front(), 1000u);
  EXPECT_EQ(large.zones[0].size(), 2500u);
  EXPECT_EQ(large.zones[1].front(), 3500u);
  EXPECT_EQ(large.zones[1].back(), 5999u);
  for (std::uint32_t area : {0u, 1u}) {
    ASSERT_EQ(contacts.areas[area].mobile_ids.size(), 50u);
    for (std::uint32_t i = 0; i < 50; ++i) EXPECT_EQ(contacts.areas[area].mobile_ids[i], 2 * i + area);
  }
}

TEST(FrameDecoder, OrdersWhatADeviceLeavesInAnyOrder) {
  Output output;
  FrameDecoder decoder;
  Contacts contacts;
  decoder.decode(output.lists(), contacts);
  expect_right(contacts);
  output.shuffle();
  decoder.decode(output.lists(), contacts);
  expect_right(contacts);
}

// A frame that is like the one before finds room where it needs it, area by area: memory that was swapped
// between a small and a large area would grow again and again, and pages that are new take longer than all
// else.
TEST(FrameDecoder, AllocatesNothingForTheSameContactAgain) {
  for (const bool shuffled : {false, true}) {
    Output output;
    if (shuffled) output.shuffle();
    FrameDecoder decoder;
    Contacts contacts;
    for (const Output& before : {Output(3, 8), Output(3, 8)})
      decoder.decode(before.lists(), contacts);  // tables that have nothing to do with the contact's size
    decoder.decode(output.lists(), contacts);
    for (int frame = 0; frame < 3; ++frame) {
      const std::size_t before = allocations_of_this_thread();
      decoder.decode(output.lists(), contacts);
      EXPECT_EQ(allocations_of_this_thread(), before) << "frame " << frame << (shuffled ? ", shuffled" : "");
      expect_right(contacts);
    }
  }
}

}  // namespace
}  // namespace palpate

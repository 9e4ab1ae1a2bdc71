// Work that is shared out is done once, whoever does it, and ends when it has to.
#include "service/queries/side_by_side.h"

#include <gtest/gtest.h>

#include <atomic>
#include <map>
#include <mutex>
#include <new>
#include <set>
#include <thread>
#include <vector>

#include "model/processors.h"
#include "model/shared_backend.h"

namespace palpate {
namespace {

/// Answers nothing; can have others, and counts them.
class Shareable final : public CollisionBackend, public SharedBackend {
 public:
  explicit Shareable(bool shares = true) : shares_(shares) {}
  Another another() const override {
    if (!shares_) return {};
    return [this]() -> std::unique_ptr<CollisionBackend> {
      ++made;
      return std::make_unique<Shareable>();
    };
  }
  Result<void> prepare(const SceneGeometry&, const Plan&, const Progress&) override { return {}; }
  Result<void> query(const LatticePose&, const Ignored*, Contacts&) override { return {}; }
  Result<VoxelPartition> partition(bool) const override { return VoxelPartition{}; }
  bool has_internal_voxels() const override { return false; }
  std::string name() const override { return "cpu"; }
  std::string device() const override { return "nothing"; }
  std::uint64_t memory_bytes() const override { return 0; }

  mutable std::size_t made = 0;

 private:
  bool shares_;
};

constexpr std::size_t kPieces = 1000;
bool always(std::size_t) { return true; }

TEST(SideBySide, EachPieceIsDoneOnceByOneThreadABackEnd) {
  Shareable own, a, b;
  std::vector<CollisionBackend*> others{&a, &b};
  std::vector<std::atomic<int>> times(kPieces);
  std::mutex mutex;
  std::map<CollisionBackend*, std::set<std::thread::id>> asked;
  const auto done = side_by_side(
      own, others, kPieces,
      [&](CollisionBackend& backend, std::size_t i) -> Result<void> {
        ++times[i];
        const std::lock_guard lock(mutex);
        asked[&backend].insert(std::this_thread::get_id());
        return {};
      },
      always);
  ASSERT_TRUE(done);
  EXPECT_EQ(*done, kPieces);
  for (const auto& count : times) EXPECT_EQ(count, 1);
  for (const auto& [backend, threads] : asked) EXPECT_EQ(threads.size(), 1u);
  for (const std::thread::id thread : asked[&own]) EXPECT_EQ(thread, std::this_thread::get_id());
}

TEST(SideBySide, WhoIsToldToEndHasDoneTheFirstPiecesAndNoOthers) {
  Shareable own, a;
  std::vector<CollisionBackend*> others{&a};
  std::vector<std::atomic<int>> times(kPieces);
  const auto done = side_by_side(
      own, others, kPieces,
      [&](CollisionBackend&, std::size_t i) -> Result<void> {
        std::this_thread::yield();
        ++times[i];
        return {};
      },
      [](std::size_t begun) { return begun < 100; });
  ASSERT_TRUE(done);
  for (std::size_t i = 0; i < kPieces; ++i) EXPECT_EQ(times[i], i < *done ? 1 : 0) << i;
  // With all pieces begun nobody is asked whether to go on.
  const auto all = side_by_side(
      own, {}, 3, [](CollisionBackend&, std::size_t) { return Result<void>(); },
      [](std::size_t begun) { return begun < 3; });
  EXPECT_EQ(*all, 3u);
}

TEST(SideBySide, AnErrorEndsTheWhole) {
  Shareable own, a;
  std::vector<CollisionBackend*> others{&a};
  const auto failing = [](CollisionBackend&, std::size_t i) -> Result<void> {
    if (i == 10) return Error{ErrorCode::kInternal, "ten"};
    return {};
  };
  const auto done = side_by_side(own, others, kPieces, failing, always);
  ASSERT_FALSE(done);
  EXPECT_EQ(done.error().sentence, "ten");

  std::size_t begun = 0;
  const auto alone = side_by_side(
      own, {}, kPieces,
      [&](CollisionBackend&, std::size_t i) -> Result<void> {
        begun = i + 1;
        if (i == 10) throw std::bad_alloc();
        return {};
      },
      always);
  ASSERT_FALSE(alone);
  EXPECT_EQ(alone.error().sentence, "there was no memory left for a pose");
  EXPECT_EQ(begun, 11u);
}

TEST(Fellows, AreMadeWhereTheyAreWorthItAndOnce) {
  Shareable own;
  Fellows fellows(own);
  const auto nothing = [](CollisionBackend&, std::size_t) { return Result<void>(); };
  EXPECT_EQ(*fellows.ask(3, nothing, always), 3u);
  EXPECT_EQ(own.made, 0u);
  for (int i = 0; i < 2; ++i) EXPECT_EQ(*fellows.ask(kPieces, nothing, always), kPieces);
  EXPECT_EQ(own.made, processors() - 1);

  Shareable lonely(false);
  EXPECT_EQ(*Fellows(lonely).ask(kPieces, nothing, always), kPieces);
  EXPECT_EQ(*Fellows(lonely).ask(0, nothing, always), 0u);
}

}  // namespace
}  // namespace palpate
